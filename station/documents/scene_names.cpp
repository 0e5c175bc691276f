#include "station/documents/scene_names.h"

#include <nlohmann/json.hpp>

namespace station {

using nlohmann::json;
namespace fs = std::filesystem;

std::string name_from(const fs::path& folder, const fs::path& file) {
  return fs::weakly_canonical(file).lexically_proximate(fs::weakly_canonical(folder)).string();
}

json moved_scene(json scene, const fs::path& from, const fs::path& to) {
  const auto move = [&](json& holder, const char* key) {
    if (holder.is_object() && holder.contains(key) && holder[key].is_string())
      holder[key] = name_from(to, from / holder[key].get<std::string>());
  };
  if (!scene.is_object()) return scene;
  if (scene.contains("threads"))
    for (json& thread : scene["threads"])
      if (thread.is_string()) thread = name_from(to, from / thread.get<std::string>());
  for (const char* list : {"cloths", "embroideries", "objects", "lights"})
    if (scene.contains(list))
      for (json& entry : scene[list]) {
        for (const char* key : {"draft", "patch", "file", "motif"}) move(entry, key);
        for (const char* part : {"shape", "absorption"})
          if (entry.is_object() && entry.contains(part)) move(entry[part], "file");
      }
  return scene;
}

}  // namespace station

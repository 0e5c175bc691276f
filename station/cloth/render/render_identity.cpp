#include "station/cloth/render/render_identity.h"

#include <map>

#include "station/documents/disk/sha256.h"
#include "station/documents/reader.h"

namespace station {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

// By name as written, so that a scene may move with its folder.
using FilesByName = std::map<std::string, fs::path>;

void add_file(const fs::path& file, const std::string& name, FilesByName& files);

void add_named_files(const json& document, const fs::path& folder, FilesByName& files) {
  if (document.is_structured()) {
    for (const json& part : document) add_named_files(part, folder, files);
  } else if (document.is_string()) {
    const auto& name = document.get_ref<const std::string&>();
    std::error_code not_a_name;
    if (fs::is_regular_file(folder / name, not_a_name)) add_file(folder / name, name, files);
  }
}

void add_file(const fs::path& file, const std::string& name, FilesByName& files) {
  if (!files.emplace(name, file).second) return;
  if (file.extension() == ".json" || file.extension() == ".gltf")
    add_named_files(read_json_file(file), file.parent_path(), files);
}

FilesByName named_files(const fs::path& scene) {
  FilesByName files{{"", scene}};
  add_named_files(read_json_file(scene), scene.parent_path(), files);
  return files;
}

}  // namespace

std::string sha256_of_scene(const fs::path& scene) {
  std::map<std::string, std::string> hashes;
  for (const auto& [name, file] : named_files(scene)) hashes.emplace(name, sha256_of_file(file));
  return sha256_hex(json(hashes).dump());
}

std::vector<fs::path> files_of_scene(const fs::path& scene) {
  std::vector<fs::path> files;
  for (const auto& [name, file] : named_files(scene)) files.push_back(file);
  return files;
}

json to_json(const RenderIdentity& identity) {
  return {{"scene_sha256", identity.scene_sha256},
          {"software", identity.software},
          {"seed", identity.seed},
          {"samples_per_pixel", identity.samples_per_pixel},
          {"noise", identity.noise}};
}

std::optional<std::string> difference(const json& other, const RenderIdentity& identity) {
  const std::map<std::string, std::string> names{
      {"software", "software "}, {"seed", "seed "}, {"samples_per_pixel", "samples per pixel "}, {"noise", "noise "}};
  const json asked = to_json(identity);
  if (other.value("scene_sha256", json()) != identity.scene_sha256)
    return "another scene (or a file that it names changed)";
  for (const auto& [key, name] : names) {
    const json found = other.contains(key) ? other.at(key) : json();
    if (found != asked.at(key)) return name + found.dump() + ", not " + asked.at(key).dump();
  }
  return std::nullopt;
}

}  // namespace station

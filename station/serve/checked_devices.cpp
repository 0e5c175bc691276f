#include "station/serve/checked_devices.h"

#include <algorithm>
#include <fstream>
#include <string>

namespace station {
namespace {

using nlohmann::json;
constexpr const char* kOfCheck = "-check";

// The table that a check printed; none while it has not, or when it could not.
json table_in(const std::filesystem::path& said) {
  std::ifstream stream(said);
  json table;
  for (std::string line; std::getline(stream, line);)
    if (const json document = json::parse(line, nullptr, false); document.is_array()) table = document;
  return table;
}

}  // namespace

json checked_devices(const Workspace& workspace, const RigFile& rig) {
  json found{{"devices", json::array()}, {"checked_ms", nullptr}};
  const std::filesystem::path jobs = workspace.folder() / "jobs";
  std::vector<std::string> names = files_in(jobs, ".out");  // sorted by time: they begin with it
  std::ranges::reverse(names);
  for (const std::string& name : names) {
    if (!name.ends_with(kOfCheck)) continue;
    const json table = table_in(jobs / (name + ".out"));
    if (table.is_null()) continue;
    found["devices"] = table;
    found["checked_ms"] = std::stoll(name);
    return found;
  }
  for (const std::string& device : {"turntable (" + rig.turntable_driver + ")", "camera (" + rig.camera_driver + ")"})
    found["devices"].push_back({{"device", device}, {"passed", nullptr}, {"rows", json::array()}});
  return found;
}

}  // namespace station

#include "station/serve/checked_devices.h"

#include <algorithm>
#include <fstream>
#include <string>
#include <utility>
#include <vector>

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

// The table of the last check and when it was made; null where there was none.
std::pair<json, long long> last_check(const Workspace& workspace) {
  const std::filesystem::path jobs = workspace.folder() / "jobs";
  std::vector<std::string> names = files_in(jobs, ".out");  // sorted by time: they begin with it
  std::ranges::reverse(names);
  for (const std::string& name : names) {
    if (!name.ends_with(kOfCheck)) continue;
    if (json table = table_in(jobs / (name + ".out")); !table.is_null()) return {std::move(table), std::stoll(name)};
  }
  return {};
}

}  // namespace

json devices_summary(const Workspace& workspace) {
  const auto [table, checked_ms] = last_check(workspace);
  if (table.is_null()) return {{"passed", nullptr}, {"checked_ms", nullptr}};
  const bool passed = std::ranges::all_of(table, [](const json& device) { return device.value("passed", false); });
  return {{"passed", passed}, {"checked_ms", checked_ms}};
}

json checked_devices(const Workspace& workspace, const RigFile& rig) {
  json found{{"devices", json::array()}, {"checked_ms", nullptr}};
  if (const auto [table, checked_ms] = last_check(workspace); !table.is_null())
    return {{"devices", table}, {"checked_ms", checked_ms}};
  for (const std::string& device : {"turntable (" + rig.turntable_driver + ")", "camera (" + rig.camera_driver + ")"})
    found["devices"].push_back({{"device", device}, {"passed", nullptr}, {"rows", json::array()}});
  return found;
}

}  // namespace station

#include "station/serve/calibration_line.h"

#include <cmath>

#include "station/bench/calibrate/error_budget.h"
#include "station/documents/calibration_file.h"
#include "station/documents/disk/stored_file.h"

namespace station {
namespace {

using nlohmann::json;

json gate_document(const calibration::Gate& gate) {
  const bool at_least = gate.passed ? gate.value > gate.limit : gate.value < gate.limit;
  return {{"name", gate.name},     {"value", std::isfinite(gate.value) ? json(gate.value) : json()},
          {"limit", gate.limit},   {"at_least", at_least},
          {"passed", gate.passed}, {"reason", gate.reason}};
}

}  // namespace

json calibration_in_full(const std::filesystem::path& folder) {
  json document{{"name", folder.filename().string()}};
  if (!std::filesystem::exists(folder / "calibration.json")) return document;
  try {
    const RigCalibration calibration = read_calibration(folder);
    document["utc"] = calibration.utc;
    document["rig"] = calibration.rig_name;
    document["camera"] = calibration.camera.model + " " + calibration.camera.serial;
    document["report"] = std::filesystem::exists(folder / "calibration.html");
    for (const calibration::Gate& gate : all_gates(calibration)) document["gates"].push_back(gate_document(gate));
    const std::vector<ErrorShare> front = error_budget(calibration, false), behind = error_budget(calibration, true);
    for (std::size_t i = 0; i < front.size(); ++i)
      document["budget"].push_back(
          {{"source", front[i].source}, {"front", front[i].relative}, {"behind", behind[i].relative}});
  } catch (const std::exception& problem) {
    document["problem"] = problem_line(problem);
  }
  return document;
}

json CalibrationLines::line(const std::filesystem::path& folder) {
  std::error_code error;
  const auto time = std::filesystem::last_write_time(folder / "calibration.json", error);
  const std::string name = folder.filename().string();
  if (error) return {{"name", name}};
  const std::scoped_lock lock(mutex_);
  Known& known = known_[name];
  if (!known.line.is_null() && known.time == time) return known.line;
  json line = calibration_in_full(folder);
  if (line.contains("budget")) {
    line["error_front"] = line["budget"].back()["front"];
    line["error_behind"] = line["budget"].back()["behind"];
    line.erase("budget");
  }
  known = {.time = time, .line = line};
  return line;
}

}  // namespace station

#include "station/documents/gate_list.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace station {
namespace {

constexpr double kLargest = 1e99;  // JSON has no infinity

}  // namespace

nlohmann::json to_json(const std::vector<calibration::Gate>& gates) {
  nlohmann::json list = nlohmann::json::array();
  for (const calibration::Gate& gate : gates)
    list.push_back({{"name", gate.name},
                    {"value", std::isnan(gate.value) ? kLargest : std::clamp(gate.value, -kLargest, kLargest)},
                    {"limit", gate.limit},
                    {"passed", gate.passed},
                    {"reason", gate.reason}});
  return list;
}

std::vector<calibration::Gate> parse_gates(ObjectReader& reader, const std::string& key) {
  std::vector<calibration::Gate> gates;
  for (ObjectReader& entry : reader.objects(key)) {
    calibration::Gate gate;
    gate.name = entry.text("name");
    gate.value = entry.number("value", -kLargest, kLargest);
    gate.limit = entry.number("limit", -kLargest, kLargest);
    gate.passed = entry.flag("passed");
    gate.reason = entry.text("reason");
    entry.finish();
    gates.push_back(gate);
  }
  return gates;
}

std::string failed_gates(const std::vector<calibration::Gate>& gates) {
  std::string text;
  for (const calibration::Gate& gate : gates) {
    if (gate.passed) continue;
    char numbers[80];
    std::snprintf(numbers, sizeof numbers, ": %.3g, limit %.3g", gate.value, gate.limit);
    text += (text.empty() ? "" : "; ") + gate.name + numbers + " (" + gate.reason + ")";
  }
  return text;
}

}  // namespace station

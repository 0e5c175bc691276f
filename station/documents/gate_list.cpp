#include "station/documents/gate_list.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <stdexcept>

namespace station {
namespace {

constexpr double kLargest = 1e99;  // JSON has no infinity

}  // namespace

nlohmann::json gates_json(const std::vector<calibration::Gate>& gates) {
  nlohmann::json list = nlohmann::json::array();
  for (const calibration::Gate& gate : gates)
    list.push_back({{"name", gate.name},
                    {"value", std::isnan(gate.value) ? kLargest : std::clamp(gate.value, -kLargest, kLargest)},
                    {"limit", gate.limit},
                    {"passed", gate.passed},
                    {"reason", gate.reason}});
  return list;
}

std::vector<calibration::Gate> parse_gates(ObjectReader& reader) {
  std::vector<calibration::Gate> gates;
  for (ObjectReader& entry : reader.objects("gates")) {
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

void refuse_failed_gates(const std::vector<calibration::Gate>& gates, const std::string& what) {
  std::string reasons;
  for (const calibration::Gate& gate : gates) {
    if (gate.passed) continue;
    char numbers[80];
    std::snprintf(numbers, sizeof numbers, " is %.3g, limit %.3g: ", gate.value, gate.limit);
    reasons += (reasons.empty() ? "" : "; ") + gate.name + numbers + gate.reason;
  }
  if (!reasons.empty()) throw std::runtime_error(what + " is not good enough: " + reasons);
}

}  // namespace station

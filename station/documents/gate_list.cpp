#include "station/documents/gate_list.h"

#include <cstdio>

namespace station {

nlohmann::json gates_json(const std::vector<calibration::Gate>& gates) {
  nlohmann::json list = nlohmann::json::array();
  for (const calibration::Gate& gate : gates)
    list.push_back({{"name", gate.name},
                    {"value", gate.value},
                    {"limit", gate.limit},
                    {"passed", gate.passed},
                    {"reason", gate.reason}});
  return list;
}

std::vector<calibration::Gate> parse_gates(ObjectReader& reader) {
  constexpr double kMost = 1e300;
  std::vector<calibration::Gate> gates;
  for (ObjectReader& entry : reader.objects("gates")) {
    gates.push_back({.name = entry.text("name"),
                     .value = entry.number("value", -kMost, kMost),
                     .limit = entry.number("limit", -kMost, kMost),
                     .passed = entry.flag("passed"),
                     .reason = entry.text("reason")});
    entry.finish();
  }
  return gates;
}

std::string failed_gates(const std::vector<calibration::Gate>& gates) {
  std::string text;
  for (const calibration::Gate& gate : gates) {
    if (gate.passed) continue;
    char numbers[80];
    std::snprintf(numbers, sizeof numbers, " is %.4g, the limit is %.4g (", gate.value, gate.limit);
    text += (text.empty() ? "" : "; ") + gate.name + numbers + gate.reason + ")";
  }
  return text;
}

}  // namespace station

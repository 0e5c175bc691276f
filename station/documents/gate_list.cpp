#include "station/documents/gate_list.h"

#include <stdexcept>

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

void refuse_failed_gates(const std::vector<calibration::Gate>& gates, const std::string& what) {
  std::string reasons;
  for (const calibration::Gate& gate : gates)
    if (!gate.passed)
      reasons += (reasons.empty() ? "" : "; ") + gate.name + " is " + std::to_string(gate.value) + ", limit " +
                 std::to_string(gate.limit) + ": " + gate.reason;
  if (!reasons.empty()) throw std::runtime_error(what + " is not good enough: " + reasons);
}

}  // namespace station

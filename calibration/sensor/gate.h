// One acceptance check of a calibration: the value that was measured, its limit (from above or below), and the reason.
#pragma once

#include <string>
#include <vector>

namespace calibration {

struct Gate {
  std::string name;  // with its unit, e.g. "board tilt, deg"
  double value = 0.0, limit = 0.0;
  bool passed = false;
  std::string reason;  // one sentence that says what the limit is for and what to do when it is not kept
};

inline Gate at_most(const std::string& name, double value, double limit, const std::string& reason) {
  return {.name = name, .value = value, .limit = limit, .passed = value <= limit, .reason = reason};  // NaN fails
}

inline Gate at_least(const std::string& name, double value, double limit, const std::string& reason) {
  return {.name = name, .value = value, .limit = limit, .passed = value >= limit, .reason = reason};
}

inline bool all_passed(const std::vector<Gate>& gates) {
  for (const Gate& gate : gates)
    if (!gate.passed) return false;
  return true;
}

}  // namespace calibration

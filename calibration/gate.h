// One check that a calibration must pass: what was found against what is allowed, with a sentence for people.
#pragma once

#include <string>

namespace calibration {

struct Gate {
  std::string name;
  double value = 0.0, limit = 0.0;
  bool passed = false;
  std::string reason;
};

}  // namespace calibration

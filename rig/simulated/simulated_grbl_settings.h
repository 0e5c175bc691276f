// The numbered settings of simulated GRBL firmware ("$100=40"), as 1.1h has them for three axes, and the options that
// it was built with.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "rig/simulated/simulated_motor.h"

namespace rig {

class SimulatedGrblSettings {
 public:
  SimulatedGrblSettings(const SimulatedMotor& motor, bool with_switch);
  double at(int number) const { return values_.at(number); }
  int set(const std::string& line);        // does a line like "$100=40"; returns 0 or the status code of its error
  std::vector<std::string> lines() const;  // the lines that "$$" prints
  bool homes_single_axis() const { return with_switch_; }  // with $HX: built for a turntable that has a switch
  std::string options() const;                             // as "$I" prints them: "VH,15,128"

 private:
  bool with_switch_;
  std::map<int, double> values_;
};

}  // namespace rig

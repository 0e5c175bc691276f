// The simulated devices of a rig as another program serves them.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "tests/station/commands/program.h"

namespace station_test {

// `threadstation simulate-hardware` in the background, until ctrl-C when this object is destroyed.
class SimulatedHardware {
 public:
  // `faults`: the path of a fault plan; empty: nothing goes wrong.
  explicit SimulatedHardware(const nlohmann::json& rig, const std::string& faults = {});
  ~SimulatedHardware();
  SimulatedHardware(const SimulatedHardware&) = delete;
  SimulatedHardware& operator=(const SimulatedHardware&) = delete;

  // Where the rig's turntable and camera are found; empty when it simulates none on a wire.
  std::string turntable_port() const;
  std::string camera_port() const;

 private:
  TemporaryFolder folder_;
  nlohmann::json ports_;
  pid_t process_ = -1;
};

}  // namespace station_test

// Simulated firmware of turntable controllers: it speaks the real wire protocols and turns the simulated bench's
// platform. Time is that of the injected clock.
//
// The GRBL firmware follows GRBL 1.1h: settings, planner, holds, jogs, homing, alarms, locks, reports; of its three
// axes only the first turns. The Zaber firmware follows the ASCII protocol of a rotary stage: message numbers, check
// sums, warnings, rejections.
#pragma once

#include <memory>
#include <string>
#include <string_view>

#include "rig/simulated/simulated_motor.h"

namespace rig {

enum class Breakdown { reset, alarm, jam };

class SimulatedFirmware {
 public:
  virtual ~SimulatedFirmware() = default;
  virtual void power_on() = 0;  // forgets the position and says the greeting
  virtual void receive(std::string_view bytes) = 0;
  virtual std::string transmit() = 0;  // what the firmware has said since the last call
  virtual void break_down(Breakdown breakdown) = 0;
};

// `with_switch` adds a home switch: after homing and its pull-off the platform stands at the true angle 0.
std::unique_ptr<SimulatedFirmware> make_simulated_grbl(SimulatedMotor motor, Clock& clock, bool with_switch);
std::unique_ptr<SimulatedFirmware> make_simulated_zaber(SimulatedMotor motor);

// A wrong device on the port: it sends back whatever it receives.
std::unique_ptr<SimulatedFirmware> make_echo();

}  // namespace rig

// Controllers of a turntable that exist as programs only: they speak the real wire protocols and turn the simulated
// bench's platform. Time is the injected clock's.
//
// The GRBL one follows GRBL 1.1h: settings, planner, holds, jogs, homing, alarms, locks, reports; one axis turns, two are
// there. The Zaber one follows the ASCII protocol of a rotary stage: message numbers, check sums, warnings, rejections.
#pragma once

#include <memory>
#include <string>
#include <string_view>

#include "rig/turntables/simulated_motor.h"

namespace rig {

enum class Breakdown { reset, alarm, jam };

class SimulatedFirmware {
 public:
  virtual ~SimulatedFirmware() = default;
  virtual void power_on() = 0;  // forgets where it was and says its greeting
  virtual void receive(std::string_view bytes) = 0;
  virtual std::string transmit() = 0;  // what it has said since it was asked last
  virtual void break_down(Breakdown breakdown) = 0;
};

// `with_switch`: a home switch, at the platform's true angle 0 when the pull-off is done.
std::unique_ptr<SimulatedFirmware> make_simulated_grbl(SimulatedMotor motor, Clock& clock, bool with_switch);
std::unique_ptr<SimulatedFirmware> make_simulated_zaber(SimulatedMotor motor);

// Sends back whatever it receives: a wrong device on the port.
std::unique_ptr<SimulatedFirmware> make_echo();

}  // namespace rig

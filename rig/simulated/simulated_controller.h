// The common part of the simulated motor controllers: bytes in and out, the power switch, and how they break down.
#pragma once

#include <string>

#include "rig/simulated/simulated_firmware.h"

namespace rig {

class SimulatedController : public SimulatedFirmware {
 public:
  void power_on() final;
  void receive(std::string_view bytes) final;
  std::string transmit() final;
  void break_down(Breakdown breakdown) final;

 protected:
  explicit SimulatedController(const SimulatedMotor& motor) : motor_(motor) {}

  virtual void start() = 0;                   // called after power-on, when the motor stands and its count is 0
  virtual void update() = 0;                  // brings the controller up to the clock's time
  virtual void take(char byte) = 0;           // receives one byte
  virtual void run_into_switch() = 0;         // does what the platform's end switch, or a stall, makes the firmware do
  void stand_and_count_from(double counted);  // stops the motor where it is and sets its count
  void say(const std::string& line) { said_ += line + "\r\n"; }

  SimulatedMotor motor_;

 private:
  std::string said_;
};

}  // namespace rig

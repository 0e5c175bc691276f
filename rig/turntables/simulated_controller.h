// What the simulated controllers of a motor have in common: bytes in and out, the power switch, and how they break down.
#pragma once

#include <string>

#include "rig/turntables/simulated_firmware.h"

namespace rig {

class SimulatedController : public SimulatedFirmware {
 public:
  void power_on() final;
  void receive(std::string_view bytes) final;
  std::string transmit() final;
  void break_down(Breakdown breakdown) final;

 protected:
  explicit SimulatedController(const SimulatedMotor& motor) : motor_(motor) {}

  virtual void start() = 0;                   // after power-on: the motor stands and counts from 0
  virtual void update() = 0;                  // all that time has brought
  virtual void take(char byte) = 0;           // of what it hears
  virtual void run_into_switch() = 0;         // or into whatever stalls the motor
  void stand_and_count_from(double counted);  // the motor stops where it is
  void say(const std::string& line) { said_ += line + "\r\n"; }

  SimulatedMotor motor_;

 private:
  std::string said_;
};

}  // namespace rig

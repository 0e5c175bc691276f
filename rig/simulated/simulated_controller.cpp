#include "rig/simulated/simulated_controller.h"

#include <utility>

namespace rig {

void SimulatedController::power_on() {
  stand_and_count_from(0);
  start();
}

void SimulatedController::receive(std::string_view bytes) {
  update();
  for (const char byte : bytes) take(byte);
  update();
}

std::string SimulatedController::transmit() {
  update();
  return std::exchange(said_, {});
}

void SimulatedController::break_down(Breakdown breakdown) {
  update();
  switch (breakdown) {
    case Breakdown::reset:
      power_on();
      break;
    case Breakdown::alarm:
      run_into_switch();
      break;
    case Breakdown::jam:
      motor_.jam(true);
      break;
  }
}

// The first halt() ends the motion; the second makes the place where the motor stands its target, in the new count.
void SimulatedController::stand_and_count_from(double counted) {
  motor_.halt();
  motor_.count_from(counted);
  motor_.halt();
}

}  // namespace rig

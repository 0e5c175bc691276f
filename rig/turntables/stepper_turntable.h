// A platform that a stepper motor turns: everything between an angle in radians and a controller's whole steps.
//
// An angle that is not finite or out of limits is refused before the wire. The platform stands at the nearest whole
// step, and angle_rad() reads that one back. A move has ended when the controller says twice that it is idle at the
// target; commands that got lost are repeated, three times at most. With backlash every position is approached by turning counter-clockwise.
// After silence, an alarm or a reset the position is unknown, and home() connects anew; with `HomeBy::here` somebody
// has to turn the platform to its mark before.
#pragma once

#include <functional>
#include <memory>

#include "rig/clock.h"
#include "rig/turntable.h"
#include "rig/turntables/motion_controller.h"

namespace rig {

struct StepperSetup {
  HomeBy home_by = HomeBy::here;
  double limit_rad = 6.283185307179586;  // either way, one turn
  double backlash_rad = 0;
  double move_timeout_s = 120;  // of one move; homing as well
  double stall_timeout_s = 3;   // moving without a changed reading
};

// Opens the line and speaks to the controller; called again after it was lost, when it may have another name.
using ConnectController = std::function<std::shared_ptr<MotionController>()>;

// Connects at once. The clock must outlive the turntable. Errors: those of `connect`.
std::unique_ptr<Turntable> make_stepper_turntable(ConnectController connect, Clock& clock, const StepperSetup& setup);

}  // namespace rig

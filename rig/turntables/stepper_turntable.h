// A turntable driven by a stepper motor: it turns angles in radians into a controller's whole steps and watches the
// moves.
//
// An angle that is not finite or out of limits is refused before anything is sent. The platform stands at the nearest
// whole step, which angle_rad() reads back. A move has ended when the controller reports twice that it is idle at the
// target; a command that got lost is repeated, three times at most. With backlash, every position is approached by
// turning counter-clockwise. After silence, an alarm or a reset the position is unknown, and home() connects anew; with
// `HomeBy::here` somebody has to turn the platform to its mark before.
#pragma once

#include <functional>
#include <memory>

#include "rig/devices/clock.h"
#include "rig/devices/turntable.h"
#include "rig/turntables/motion_controller.h"

namespace rig {

struct StepperSetup {
  HomeBy home_by = HomeBy::here;
  double limit_rad = 6.283185307179586;  // largest angle either way: one turn
  double backlash_rad = 0;
  double move_timeout_s = 120;  // for one move or one homing
  double stall_timeout_s = 3;   // for a move during which the reading does not change
};

// Opens the line and connects to the controller. It is called again after the controller was lost; the port may then
// have another name.
using ConnectController = std::function<std::shared_ptr<MotionController>()>;

// A turntable that has called `connect`. The clock must outlive it. Errors: those of `connect`.
std::unique_ptr<Turntable> make_stepper_turntable(ConnectController connect, Clock& clock, const StepperSetup& setup);

}  // namespace rig

// The two kinds of controller that are spoken to, each on a line that is open.
//
// Connecting resets the controller, asks what it is and compares its set-up with what the rig file says.
#pragma once

#include <memory>

#include "rig/clock.h"
#include "rig/turntables/byte_line.h"
#include "rig/turntables/motion_controller.h"

namespace rig {

struct ControllerSetup {
  double steps_per_deg = 0;  // as the rig file says; the controller's own must agree
  HomeBy home_by = HomeBy::here;
  double reply_timeout_s = 2;            // silence for so long is an error
  double banner_timeout_s = 5;           // boards that are reset by opening their port take two seconds to start
  int zaber_device = 1, zaber_axis = 1;  // of a chain of stages on one line
  int zaber_resolution = 64;             // microsteps per step that `steps_per_deg` is meant for
};

std::unique_ptr<MotionController> connect_grbl(std::shared_ptr<ByteLine> line, Clock& clock,
                                               const ControllerSetup& setup);
std::unique_ptr<MotionController> connect_zaber(std::shared_ptr<ByteLine> line, Clock& clock,
                                                const ControllerSetup& setup);

}  // namespace rig

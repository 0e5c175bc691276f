// Connections to the two kinds of motor controller, GRBL and Zaber, each on an open line.
//
// Connecting ends any motion (GRBL is reset), asks the controller what it is and compares its set-up with the rig file.
#pragma once

#include <memory>

#include "rig/devices/clock.h"
#include "rig/turntables/byte_line.h"
#include "rig/turntables/motion_controller.h"

namespace rig {

inline constexpr int kMostTries = 4;        // of a question: asked once and repeated three times
inline constexpr double kPollS = 0.05;      // between questions whether the platform still turns
inline constexpr double kSameRatio = 1e-4;  // rounding when steps per degree are written down in two places

struct ControllerSetup {
  double steps_per_deg = 0;  // from the rig file; the controller's own value must agree; 0: it is not known yet
  HomeBy home_by = HomeBy::here;
  bool homes_x_alone = false;            // GRBL's $H was built to home no other axis than X
  double reply_timeout_s = 2;            // a silence of this length is an error
  double banner_timeout_s = 5;           // for GRBL's greeting; boards reset by opening their port start in two seconds
  int zaber_device = 1, zaber_axis = 1;  // which stage in a chain of stages on one line
  int zaber_resolution = 64;             // microsteps per full step for which `steps_per_deg` holds
};

// Errors: those of MotionController; std::runtime_error when the set-up differs, saying which setting to change.
std::unique_ptr<MotionController> connect_grbl(std::shared_ptr<ByteLine> line, Clock& clock,
                                               const ControllerSetup& setup);
std::unique_ptr<MotionController> connect_zaber(std::shared_ptr<ByteLine> line, Clock& clock,
                                                const ControllerSetup& setup);

}  // namespace rig

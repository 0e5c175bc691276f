// Checks of what every camera and every turntable must do. They run against simulated devices in the tests and against
// the real ones before a session. A device that throws where it must not fails the row, which then holds its message.
#pragma once

#include <string>
#include <vector>

#include "rig/devices/camera.h"
#include "rig/devices/turntable.h"

namespace rig {

struct ContractRow {
  std::string name;  // a sentence that is true when the row passed
  bool passed = false;
  std::string what;  // what the check saw
};

// Turns the platform, which must be free to turn, through a few angles between 0 and 90 degrees and back to 0. Readings
// may differ from the angles asked for by `tolerance_rad` (one step of the device). A platform with a motor is stopped
// before it is turned for longer: it must stand within 5 degrees.
std::vector<ContractRow> check_turntable(Turntable& turntable, double tolerance_rad, bool has_motor = true);

// Takes four short pictures of whatever stands in front of the camera; changes the exposure settings.
std::vector<ContractRow> check_camera(Camera& camera);

bool all_passed(const std::vector<ContractRow>& rows);

}  // namespace rig

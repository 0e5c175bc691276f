// What every camera and every turntable must do, as rows that run against any of them: the simulated twins in the
// tests, the real devices before a session. A device that throws where it must not fails the row with its own words.
#pragma once

#include <string>
#include <vector>

#include "rig/camera.h"
#include "rig/turntable.h"

namespace rig {

struct ContractRow {
  std::string name;  // a sentence that is true when the row passed
  bool passed = false;
  std::string what;  // what was seen
};

// Turns the platform through a few angles between 0 and 90 degrees and back; it must be free to turn. Readings may
// differ from what was asked by `tolerance_rad` (one step of the device). Ends at angle 0.
std::vector<ContractRow> check_turntable(Turntable& turntable, double tolerance_rad);

// Takes four short pictures of whatever stands there, and changes the exposure settings.
std::vector<ContractRow> check_camera(Camera& camera);

bool all_passed(const std::vector<ContractRow>& rows);

}  // namespace rig

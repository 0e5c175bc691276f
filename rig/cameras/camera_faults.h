// What goes wrong with a simulated camera on the network, and at which operation: data, so that a test sweeps over it and
// a file can hold it. An operation is a question of the host to the camera (PTP's unit).
#pragma once

#include <vector>

namespace rig {

enum class CameraFault {
  silence,      // nothing is done and nothing answered
  lost_answer,  // done, and not answered
  cut,          // the connection breaks in the middle of the answer: a truncated file
  garbage,      // the answer is noise
  unplug,       // the camera is gone until it is plugged in
  // From here on this setting is accepted and not done.
  refused_shutter,
  refused_iso,
  refused_f_number,
  refused_quality,
  overstepped,    // from here on it goes one step further than it was asked
  stale_picture,  // from here on the picture before is delivered again
  store_full,     // from here on
  battery_empty,  // from here on
  dial_turned     // from here on another mode than M
};

struct PlannedCameraFault {
  int at_operation = 1;  // the first is 1
  CameraFault fault = CameraFault::silence;
};
using CameraFaultPlan = std::vector<PlannedCameraFault>;

}  // namespace rig

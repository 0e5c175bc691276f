// The plan of what goes wrong with a simulated camera on the network, and at which operation. It is plain data, so that
// a test can sweep over it and a file can hold it. An operation (PTP's term) is one question of the host to the camera.
#pragma once

#include <vector>

namespace rig {

enum class CameraFault {
  silence,      // the operation is neither done nor answered
  lost_answer,  // it is done and not answered
  cut,          // the connection breaks in the middle of the answer: a truncated file
  garbage,      // the answer is noise
  unplug,       // the camera is gone until it is plugged in
  // The rest last from this operation on. A refused setting is accepted and not done.
  refused_shutter,
  refused_iso,
  refused_f_number,
  refused_quality,
  overstepped,    // settings go one step further than asked
  stale_picture,  // the previous picture is delivered again
  store_full,
  battery_empty,
  dial_turned  // the mode dial stands at another mode than M
};

struct PlannedCameraFault {
  int at_operation = 1;  // the first is 1
  CameraFault fault = CameraFault::silence;
};
using CameraFaultPlan = std::vector<PlannedCameraFault>;

}  // namespace rig

// Which pictures a rig calibration needs: the tag board in the hand (lens), standing on the turning platform and lying
// on it (axis, world frame), the sensor's pictures (response_plan.h), and the Spectralon panel under the lamp in front
// and behind (light, vignetting).
#pragma once

#include <string>
#include <vector>

#include "station/bench/calibrate/calibration_step.h"
#include "station/documents/rig_file.h"

namespace station {

std::vector<CalibrationStep> make_calibration_plan(const RigFile& rig);

}  // namespace station

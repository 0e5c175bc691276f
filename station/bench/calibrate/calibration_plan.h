// Which pictures a rig calibration needs, in an order in which a person does little: the empty platform turning (axis,
// world frame), the tag board on three or four stands (lens), the Spectralon panel before the lens (white field), on
// stands under the lamp in front (sensor, light, vignetting), the colour chart, darkness, and the panel under the lamp
// behind.
#pragma once

#include <string>
#include <vector>

#include "station/bench/calibrate/calibration_step.h"
#include "station/documents/rig_file.h"

namespace station {

std::vector<CalibrationStep> make_calibration_plan(const RigFile& rig);

// For each step, which of the person's actions it comes after, counted from 1.
std::vector<int> actions_of(const std::vector<CalibrationStep>& plan);

}  // namespace station

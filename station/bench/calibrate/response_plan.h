// The sensor's part of a rig calibration: which pictures measure how the camera answers to light.
//
//   response      the Spectralon panel under the lamp, one metered picture, then a ladder of whole stops up and down
//                 again, so that a lamp that drifts does so in both halves
//   rapid         ten quick ones for flicker
//   dark          no light at all, at the ladder's two ends
//   white_field   the panel close to the lens under the room light, filling the picture, for dust
#pragma once

#include <vector>

#include "station/bench/calibrate/calibration_step.h"
#include "station/documents/rig_file.h"

namespace station {

inline constexpr int kLadderLow = -7, kLadderHigh = 4;  // stops from the metered exposure

// Each adds the steps for its pictures to the plan: the ladder of exposures and rapid pictures of the panel that stands
// as in `place`; darkness, with what the plan has placed last and the exposures of the ladder's ends; the panel before
// the lens, out of focus and moving.
void add_response_steps(CalibrationStep place, std::vector<CalibrationStep>& plan);
void add_dark_steps(std::vector<CalibrationStep>& plan);
void add_white_field_steps(const RigFile& rig, std::vector<CalibrationStep>& plan);

}  // namespace station

// The lens, the lamps and the Spectralon panel of a rig file, as calibrations begin with them.
#pragma once

#include <vector>

#include "calibration/light/light_plan.h"
#include "station/documents/rig_file.h"

namespace station {

// The lens by its engraving alone, for pictures of this size.
calibration::Lens engraved_lens(const RigFile& rig, cv::Size picture);

// From the camera to the middle of what stands on the platform, by tape.
double working_distance_mm(const RigFile& rig);

std::vector<calibration::LightGuess> lamp_guesses(const RigFile& rig);  // front, back
calibration::LightOptions light_options(const RigFile& rig, cv::Size picture);
// The bench as it is known by tape, before anything is calibrated.
calibration::PanelBench panel_bench(const RigFile& rig);

}  // namespace station

// From a folder of calibration pictures to the rig's calibration: lens, platform, sensor, then light.
#pragma once

#include <filesystem>

#include "station/bench/calibrate/calibration_pictures.h"
#include "station/documents/calibration_file.h"

namespace station {

// Solves all parts. Errors: std::runtime_error when pictures are missing or cannot determine a part, saying which.
RigCalibration solve_calibration(const RigFile& rig, const std::filesystem::path& folder,
                                 const std::vector<CalibrationPicture>& pictures, const StepProgress& progress);

// A few lines for people: what was found and how well.
std::string describe(const RigCalibration& calibration);

}  // namespace station

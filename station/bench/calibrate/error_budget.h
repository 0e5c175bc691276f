// What each part of a rig calibration contributes to the error of a radiance measured at the spool.
#pragma once

#include <string>
#include <vector>

#include "station/documents/calibration_file.h"

namespace station {

struct ErrorShare {
  std::string source;
  double relative = 0.0;  // one standard deviation, of the radiance over that of a perfect diffuser
};

// The errors for a diffuse sheet at the platform's axis that is turned 45 degrees away from the lamp in front
// (`behind`: from the one behind), seen in the picture's middle. The sources are independent; the last entry is the
// whole, the root of the sum of their squares. Errors of the lens move edges by hundredths of a pixel and have no
// share.
std::vector<ErrorShare> error_budget(const RigCalibration& calibration, bool behind);

// The budget for people: one line per source with both lamps, in per cent.
std::string describe_budget(const RigCalibration& calibration);

}  // namespace station

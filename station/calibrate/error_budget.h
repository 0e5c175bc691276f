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

// For a diffuse sheet at the platform's axis that is turned 45 degrees away from the lamp in front (`behind`: from the
// one behind), seen in the picture's middle. Independent sources: the whole is the root of the sum of squares, the last
// entry. Errors of the lens move edges by hundredths of a pixel and have no share.
std::vector<ErrorShare> error_budget(const RigCalibration& calibration, bool behind);

// One line per source with both lamps, in per cent.
std::string describe_budget(const RigCalibration& calibration);

}  // namespace station

// Does the lamp flicker or drift? From mean signals of pictures of a still white surface.
#pragma once

#include <vector>

#include "calibration/gate.h"
#include "calibration/photon_transfer.h"

namespace calibration {

struct LampStability {
  double flicker =
      0;  // relative standard deviation of rapid pictures, straight drift and the pictures' own noise taken out
  double drift_per_min = 0, drift_sigma_per_min = 0;
};

// `rapid`: 10 or more pictures of one exposure, in their order. `pairs`: pictures of equal exposure some time apart
// (measure_pair with apart_s). Throws std::runtime_error when there are too few.
LampStability lamp_stability(const std::vector<SensorPicture>& rapid, const LevelBins& bins, const SensorMaps& maps,
                             const std::vector<PairLevels>& pairs);

// The lamp's strength through a series of pictures, relative to the first (1 = as then): corrected by division; a jump of
// more than 2 % asks for a pause, more than 10 % in all is no lamp to measure with.
struct LampGates {
  double largest_jump = 0.02, largest_change = 0.10;
};
std::vector<Gate> lamp_gates(const std::vector<double>& strength, const LampGates& limits = {});

}  // namespace calibration

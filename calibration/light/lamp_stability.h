// The lamp's flicker and drift, measured by the mean signals of pictures of a still white surface.
#pragma once

#include <vector>

#include "calibration/sensor/gate.h"
#include "calibration/sensor/photon_transfer.h"

namespace calibration {

struct LampStability {
  double flicker = 0;  // relative standard deviation of rapid pictures' means about a straight drift
  double drift_per_min = 0, drift_sigma_per_min = 0;
};

// Flicker from `rapid`, 10 or more pictures of one exposure in their order, and drift from `pairs` of pictures of equal
// exposure some time apart (measure_pair with apart_s). Throws std::runtime_error when there are too few pictures.
LampStability lamp_stability(const std::vector<SensorPicture>& rapid, const LevelBins& bins, const SensorMaps& maps,
                             const std::vector<PairLevels>& pairs);

// The largest change of the lamp's strength from one picture to the next and the largest in a series, both relative.
struct LampGates {
  double largest_jump = 0.02, largest_change = 0.10;
};
// Checks of the lamp's strength through a series of pictures, relative to the first. Smaller changes are corrected by
// dividing each picture by its strength; after a larger jump the lamp needs time to warm up, and a lamp that changes by
// more in all cannot be measured with.
std::vector<Gate> lamp_gates(const std::vector<double>& strength, const LampGates& limits = {});

}  // namespace calibration

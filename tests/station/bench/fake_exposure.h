#pragma once

#include <cmath>

#include "station/bench/metering.h"
#include "tests/support/fake_devices.h"

namespace station {

// Aims at a FakeCamera's level of 0.6, to a third of a stop.
inline ExposureChoice choose_fake_exposure(const PlanStep&, const rig::Picture& test) {
  const double level = FakeCamera::level(test);
  return level >= 1 ? ExposureChoice{.exposure_s = test.settings.exposure_s / 4, .done = false}
                    : ExposureChoice{.exposure_s = test.settings.exposure_s * 0.6 / level,
                                     .done = std::abs(std::log2(level / 0.6)) < 1.0 / 3};
}

}  // namespace station

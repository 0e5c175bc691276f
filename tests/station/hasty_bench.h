// The simulated bench with a sensor so coarse that drawing hardly counts: for tests of the capture itself.
#pragma once

#include <nlohmann/json.hpp>

namespace station_test {

// The same lens before a sensor of fewer, larger pixels; few samples a pixel.
nlohmann::json hasty_rig(nlohmann::json rig);

// A calibration of the fine sensor for the coarse one; the response of the fine one is left out.
nlohmann::json hasty_calibration(nlohmann::json calibration);

}  // namespace station_test

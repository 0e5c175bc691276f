// A simulated bench with a sensor so coarse that drawing takes hardly any time, for tests of the capture itself.
#pragma once

#include <nlohmann/json.hpp>

namespace station_test {

// The rig with the same lens before a sensor of fewer, larger pixels, drawn with few samples a pixel.
nlohmann::json hasty_rig(nlohmann::json rig);

// The fine sensor's calibration made to fit the coarse one; the fine one's response is left out.
nlohmann::json hasty_calibration(nlohmann::json calibration);

}  // namespace station_test

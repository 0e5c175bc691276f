// What a raw picture must have to be developed.
#pragma once

#include "calibration/sensor_file.h"

namespace calibration {

// Throws std::runtime_error for a picture without pixels, levels or exposure time, or with colours that are none of red,
// green and blue.
void require_developable(const SensorPicture& raw);

}  // namespace calibration

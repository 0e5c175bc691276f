// The check that a raw picture can be developed.
#pragma once

#include "calibration/sensor/sensor_file.h"

namespace calibration {

// Throws std::runtime_error for a picture without pixels, levels or exposure time, or with colours that are none of
// red, green and blue.
void require_developable(const SensorPicture& raw);

}  // namespace calibration

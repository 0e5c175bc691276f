// Grey of a raw picture, for what is looked for in it (tags, edges, detail).
#pragma once

#include <opencv2/core.hpp>

#include "calibration/sensor_file.h"

namespace calibration {

// Mean of the three demosaiced colours in the radiance unit, the file's black level taken off, vignetting and
// distortion left in, nothing below zero: what develop() with no options gives, in one pass and without its pictures.
// Errors: those of develop().
cv::Mat1f linear_grey(const SensorPicture& picture);

}  // namespace calibration

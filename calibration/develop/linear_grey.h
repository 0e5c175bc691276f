// The grey picture in which tags, edges and detail are looked for.
#pragma once

#include <opencv2/core.hpp>

#include "calibration/sensor/sensor_file.h"

namespace calibration {

// The grey of a raw picture: the mean of the three demosaiced colours in the radiance unit, without the file's black
// level, with vignetting and distortion left in, values below zero set to 0. It is the mean of what develop() gives
// without options, made in one pass. Errors: those of develop().
cv::Mat1f linear_grey(const SensorPicture& picture);

}  // namespace calibration

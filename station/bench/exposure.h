// Choosing an exposure time from a test picture.
#pragma once

#include <opencv2/core.hpp>
#include <optional>

#include "calibration/sensor/sensor_file.h"

namespace station {

struct ExposureAim {
  double level = 0.6;        // of the range black..white that the brightest pixels should reach
  double tolerance = 1.5;    // accepted ratio of found to wanted level, either way
  double percentile = 99.8;  // "brightest": this percentile of the region
};

// The level (0 = black, 1 = white) that `percentile` per cent of the region's raw pixels stay below. `region` is 255
// inside and has the sensor's size; an empty one is the whole picture.
double bright_level(const calibration::SensorPicture& picture, const cv::Mat1b& region, double percentile);

// The exposure time to try next, or nothing when the picture is exposed well. A saturated picture asks for an eighth of
// its own; a change is at most a factor of 64, so that the noise of a test picture cannot lead far away.
std::optional<double> next_exposure_s(const calibration::SensorPicture& picture, const cv::Mat1b& region,
                                      const ExposureAim& aim);

}  // namespace station

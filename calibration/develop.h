// Raw mosaic to linear radiance: dark or black level, exposure, flat field, demosaicing that keeps linearity, undistortion.
//
// Result: cv::Mat3f RGB in the radiance unit (1 = full scale (white - black level) per second of exposure, flat-fielded).
#pragma once

#include <opencv2/core.hpp>
#include <optional>

#include "calibration/lens.h"
#include "calibration/light.h"
#include "calibration/sensor_file.h"

namespace calibration {

// Mean of dark frames of the same exposure, DN. Throws when sizes or exposures differ.
cv::Mat1f master_dark(const std::vector<SensorPicture>& darks);

struct DevelopOptions {
  std::optional<cv::Mat1f> dark_dn;          // absent: the file's black level
  std::optional<Vignetting> vignetting;      // absent: not flat-fielded
  std::optional<Lens> lens;                  // absent: not undistorted
};

struct Developed {
  cv::Mat3f radiance;
  cv::Mat1b saturated;       // 255 where any of the raw values that a pixel was made from is above 0.98 of the range
};

Developed develop(const SensorPicture& raw, const DevelopOptions& options);

}  // namespace calibration

// The development of raw mosaics to linear radiance: dark or black level, merged exposures, bad pixels, flat field,
// demosaicing that keeps linearity, undistortion.
//
// The result is a cv::Mat3f RGB in the radiance unit (1 = full scale (white - black level) per second of exposure,
// flat-fielded). Values below 0 (noise about the dark level) are kept, so that means stay unbiased. No white balance,
// no ISO scaling. Order: dark, exposure, vignetting (on the sensor's own pixels), demosaicing, undistortion.
#pragma once

#include <opencv2/core.hpp>
#include <optional>
#include <vector>

#include "calibration/develop/developed.h"
#include "calibration/develop/merge_exposures.h"
#include "calibration/geometry/lens.h"
#include "calibration/light/light.h"
#include "calibration/sensor/sensor_file.h"

namespace calibration {

// The mean of dark frames of the same exposure, DN. Throws std::runtime_error when sizes or exposures differ.
cv::Mat1f master_dark(const std::vector<SensorPicture>& darks);

struct DevelopOptions {
  std::optional<cv::Mat1f> dark_dn{};      // used in place of the response's dark maps
  const SensorResponse* response{};        // absent: the file's black level, a linear response, nominal times
  double dark_offset_dn = 0.0;             // added to the dark level, as in merge_exposures
  std::optional<Vignetting> vignetting{};  // absent: not flat-fielded
  std::optional<Lens> lens{};              // absent: not undistorted
  std::optional<cv::Rect> part{};          // absent: the whole picture; not together with a lens
};

// Develop one picture, or a bracket of exposures merged into one. Throw std::runtime_error when sizes do not match, a
// picture has no levels or exposure, or the part is not inside it.
Developed develop(const SensorPicture& raw, const DevelopOptions& options);
Developed develop(const std::vector<SensorPicture>& bracket, const DevelopOptions& options);

}  // namespace calibration

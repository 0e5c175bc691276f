// Raw mosaics to linear radiance: dark or black level, exposures merged, bad pixels, flat field, demosaicing that keeps
// linearity, undistortion.
//
// Result: cv::Mat3f RGB in the radiance unit (1 = full scale (white - black level) per second of exposure,
// flat-fielded). Values below 0 (noise about the dark level) are kept, so that means stay unbiased. No white balance,
// no ISO scaling. Order: dark, exposure, vignetting (on the sensor's own pixels), demosaicing, undistortion.
#pragma once

#include <opencv2/core.hpp>
#include <optional>
#include <vector>

#include "calibration/lens.h"
#include "calibration/light.h"
#include "calibration/merge_exposures.h"
#include "calibration/sensor_file.h"

namespace calibration {

// Mean of dark frames of the same exposure, DN. Throws when sizes or exposures differ.
cv::Mat1f master_dark(const std::vector<SensorPicture>& darks);

struct DevelopOptions {
  std::optional<cv::Mat1f> dark_dn{};      // takes the place of the response's dark maps
  const SensorResponse* response{};        // absent: the file's black level, a straight response, engraved times
  double dark_offset_dn = 0.0;             // on the dark level, as merge_exposures
  std::optional<Vignetting> vignetting{};  // absent: not flat-fielded
  std::optional<Lens> lens{};              // absent: not undistorted
  std::optional<cv::Rect> part{};          // absent: the whole picture; not together with a lens
};

struct Developed {
  cv::Mat3f radiance;   // undistorted: same intrinsic matrix; 0 where the sensor did not see
  cv::Mat3f variance;   // of it, of a pixel by itself (neighbours share raw values); empty without a response's gain
  cv::Mat1b saturated;  // 255 where any of the raw values that a pixel was made from is above 0.98 of the range
};

// Throws std::runtime_error when sizes do not match, the picture has no levels or exposure, or the part is not in it.
Developed develop(const SensorPicture& raw, const DevelopOptions& options);
Developed develop(const std::vector<SensorPicture>& bracket, const DevelopOptions& options);

}  // namespace calibration

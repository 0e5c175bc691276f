#include "station/bench/exposure.h"

#include <algorithm>
#include <opencv2/imgproc.hpp>
#include <vector>

namespace station {

double bright_level(const calibration::SensorPicture& picture, const cv::Mat1b& region, double percentile) {
  std::vector<int> counts(1 << 16, 0);
  int all = 0;
  const bool everywhere = region.empty();
  const cv::Rect box = everywhere ? cv::Rect({}, picture.mosaic.size()) : cv::boundingRect(region);
  for (int row = box.y; row < box.br().y; ++row)
    for (int column = box.x; column < box.br().x; ++column)
      if (everywhere || region(row, column)) ++counts[picture.mosaic(row, column)], ++all;
  if (all == 0) return 0.0;
  const auto rank = static_cast<int>(percentile / 100.0 * (all - 1));
  std::size_t value = 0;
  for (int below = counts[0]; below <= rank; below += counts[value]) ++value;
  const double level =
      (static_cast<double>(value) - picture.black_level_dn) / (picture.white_level_dn - picture.black_level_dn);
  return std::clamp(level, 0.0, 1.0);
}

std::optional<double> next_exposure_s(const calibration::SensorPicture& picture, const cv::Mat1b& region,
                                      const ExposureAim& aim) {
  const double level = bright_level(picture, region, aim.percentile);
  if (level > 0.97) return picture.exposure_s / 8;
  const double ratio = aim.level / std::max(level, aim.level / 64);
  if (ratio < aim.tolerance && ratio > 1 / aim.tolerance) return std::nullopt;
  return picture.exposure_s * ratio;
}

}  // namespace station

#include "station/exposure.h"

#include <algorithm>
#include <vector>

namespace station {

double bright_level(const calibration::SensorPicture& picture, const cv::Mat1b& region, double percentile) {
  std::vector<std::uint16_t> values;
  values.reserve(picture.mosaic.total());
  for (int row = 0; row < picture.mosaic.rows; ++row)
    for (int column = 0; column < picture.mosaic.cols; ++column)
      if (region.empty() || region(row, column)) values.push_back(picture.mosaic(row, column));
  if (values.empty()) return 0.0;
  const auto rank = static_cast<std::ptrdiff_t>(percentile / 100.0 * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), values.begin() + rank, values.end());
  const double level = (values[static_cast<std::size_t>(rank)] - picture.black_level_dn) /
                       (picture.white_level_dn - picture.black_level_dn);
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

#include "inversion/view/noise_law.h"

#include <algorithm>

namespace inversion {

std::optional<NoiseLaw> noise_law(const cv::Mat3f& radiance, const cv::Mat3f& variance, const cv::Mat1b& mask) {
  if (variance.empty()) return std::nullopt;
  double count = 0;
  Eigen::Array3d x = Eigen::Array3d::Zero(), y = x, xx = x, xy = x;
  for (int row = 0; row < mask.rows; ++row)
    for (int column = 0; column < mask.cols; ++column) {
      if (!mask(row, column)) continue;
      ++count;
      for (int c = 0; c < 3; ++c) {
        const double light = std::max(0.0F, radiance(row, column)[c]), noise = variance(row, column)[c];
        x[c] += light;
        y[c] += noise;
        xx[c] += light * light;
        xy[c] += light * noise;
      }
    }
  if (count == 0) return std::nullopt;
  const Eigen::Array3d spread = xx / count - (x / count).square();
  const Eigen::Array3d together = xy / count - (x / count) * (y / count);
  NoiseLaw law;
  law.slope = (spread > 0).select(together / spread, 0.0).max(0.0);
  law.floor = ((y - law.slope * x) / count).max(0.0);
  return law;
}

Eigen::Array3d variance_by(const NoiseLaw& law, const Eigen::Array3d& radiance) {
  return law.floor + law.slope * radiance.max(0.0);
}

NoiseLaw divided(const NoiseLaw& law, double divisor) {
  return {.floor = law.floor / (divisor * divisor), .slope = law.slope / divisor};
}

}  // namespace inversion

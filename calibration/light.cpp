#include "calibration/light.h"
namespace calibration {
double Vignetting::gain(double column, double row, cv::Size image_size) const {
  const double dx = column - 0.5 * (image_size.width - 1), dy = row - 0.5 * (image_size.height - 1);
  const double r2 = 4.0 * (dx * dx + dy * dy) /
                    (static_cast<double>(image_size.width) * image_size.width +
                     static_cast<double>(image_size.height) * image_size.height);
  return 1.0 + r2 * (v0 + r2 * v1);
}
}  // namespace calibration

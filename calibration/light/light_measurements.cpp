#include "calibration/light/light_measurements.h"

namespace calibration {

double Vignetting::gain(double column, double row, cv::Size image_size) const {
  const double v[] = {v0, v1};
  return vignetting_gain(radius_squared({column, row}, image_size), v);
}

}  // namespace calibration

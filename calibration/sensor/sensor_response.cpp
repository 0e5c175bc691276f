#include "calibration/sensor/sensor_response.h"

#include <cmath>

namespace calibration {

double true_exposure_s(const SensorResponse& response, double nominal_s) {
  for (const ShutterTime& time : response.shutter)
    if (std::abs(std::log2(time.nominal_s / nominal_s)) < 1.0 / 6) return nominal_s * time.true_s / time.nominal_s;
  return nominal_s;
}

double linear_signal(const SensorResponse& response, double signal) {
  return signal * std::exp(response.nonlinearity * signal);
}

}  // namespace calibration

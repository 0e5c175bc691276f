// The shape of a panel's droop (spectralon.h), written once for double and for automatic derivatives.
#pragma once

#include <ceres/cubic_interpolation.h>

#include <cmath>

#include "calibration/sensor/degree.h"

namespace calibration {

// The published table's even Fourier coefficients in phi (1, cos phi, cos 2 phi) at theta_i, theta_e = 0, 10 ... 70
// degrees, as BRF relative to Lambertian.
using DroopTable = ceres::BiCubicInterpolator<ceres::Grid2D<double, 3>>;
const DroopTable& droop_table();

inline constexpr double kDroopStep_rad = 10.0 * kDegree;  // step between the table's rows and columns
// The table's 8 degree / hemispherical reflectance (integrated by the test), and the difference of its values at
// (incidence, view) = (0, 0) and (60, 0) degrees.
inline constexpr double kTableReflectance = 1.0283, kTableDroop = 0.160;

template <typename T>
T angle_of(const T& cosine) {
  using std::atan2, std::sqrt;
  return atan2(sqrt(T(1 + 1e-12) - cosine * cosine), cosine);  // no infinite slope at the normal
}

template <typename T>
T droop_shape(const T& cos_theta_i, const T& cos_theta_e, const T& cos_phi) {
  T c[3];
  droop_table().Evaluate(angle_of(cos_theta_i) / kDroopStep_rad, angle_of(cos_theta_e) / kDroopStep_rad, c);
  return (c[0] + c[1] * cos_phi + c[2] * (T(2) * cos_phi * cos_phi - T(1)) - kTableReflectance) / kTableDroop;
}

}  // namespace calibration

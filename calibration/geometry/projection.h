// The camera's projection and rigid motions as the fits use them, written once for double and for automatic
// derivatives.
//
// Camera frame as in OpenCV (+z forward, +y down, mm); pixels with the centre of the first pixel at (0, 0).
// Distortion: Brown's radial and tangential terms in OpenCV's order k1 k2 p1 p2 k3 (OpenCV 4 documentation, calib3d).
#pragma once

#include <ceres/rotation.h>

#include <Eigen/Geometry>
#include <array>

#include "calibration/geometry/lens.h"

namespace calibration {

template <typename T>
using Point = Eigen::Matrix<T, 3, 1>;

// fx fy cx cy k1 k2 p1 p2 k3; LensFit::covariance has the same order.
using Intrinsics = std::array<double, 9>;

inline Intrinsics intrinsics_of(const Lens& lens) {
  const auto& k = lens.distortion;
  return {lens.fx_px, lens.fy_px, lens.cx_px, lens.cy_px, k[0], k[1], k[2], k[3], k[4]};
}

template <typename T>
std::array<T, 9> constants(const Intrinsics& intrinsics) {
  std::array<T, 9> out;
  for (std::size_t i = 0; i < 9; ++i) out[i] = T(intrinsics[i]);
  return out;
}

template <typename T>
Eigen::Matrix<T, 2, 1> project(const T* intrinsics, const Point<T>& point_in_camera) {
  const T x = point_in_camera.x() / point_in_camera.z(), y = point_in_camera.y() / point_in_camera.z();
  const T &k1 = intrinsics[4], &k2 = intrinsics[5], &p1 = intrinsics[6], &p2 = intrinsics[7], &k3 = intrinsics[8];
  const T r2 = x * x + y * y;
  const T radial = T(1) + r2 * (k1 + r2 * (k2 + r2 * k3));
  const T distorted_x = x * radial + T(2) * p1 * x * y + p2 * (r2 + T(2) * x * x);
  const T distorted_y = y * radial + p1 * (r2 + T(2) * y * y) + T(2) * p2 * x * y;
  return {intrinsics[0] * distorted_x + intrinsics[2], intrinsics[1] * distorted_y + intrinsics[3]};
}

// `point` after a small motion of 6 numbers: a rotation vector (rad) about the axes of the point's frame, then a
// translation (mm) in it. The fits change poses by such motions, so that covariances are in radians and millimetres.
template <typename T>
Point<T> moved(const T* motion, const Point<T>& point) {
  Point<T> out;
  ceres::AngleAxisRotatePoint(motion, point.data(), out.data());
  return out + Eigen::Map<const Point<T>>(motion + 3);
}

using Motion = std::array<double, 6>;

inline Eigen::Isometry3d isometry_of(const Motion& motion) {
  Eigen::Matrix3d rotation;
  ceres::AngleAxisToRotationMatrix(motion.data(), rotation.data());  // both are column-major
  Eigen::Isometry3d out = Eigen::Isometry3d::Identity();
  out.linear() = rotation;
  out.translation() = Eigen::Map<const Eigen::Vector3d>(motion.data() + 3);
  return out;
}

}  // namespace calibration

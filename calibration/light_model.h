// The radiance of a Spectralon patch under a near light (light.h), written once for double and for automatic
// derivatives.
#pragma once

#include <Eigen/Geometry>
#include <cmath>

#include "calibration/droop_shape.h"
#include "calibration/light.h"

namespace calibration {

// A lamp's axis = normalised(axis + beam[0] * right + beam[1] * up): two small angles about the axis as guessed.
struct BeamFrame {
  explicit BeamFrame(const LightGuess& guess)
      : axis((guess.aim - guess.position).normalized()), right(axis.unitOrthogonal()), up(axis.cross(right)) {}
  Eigen::Vector3d axis, right, up;

  template <typename T>
  Eigen::Matrix<T, 3, 1> direction(const T* beam) const {
    return (axis.cast<T>() + beam[0] * right.cast<T>() + beam[1] * up.cast<T>()).normalized();
  }
};

// Square of the distance to the image centre, in half diagonals.
inline double radius_squared(const Eigen::Vector2d& pixel, cv::Size size) {
  const double dx = pixel.x() - 0.5 * (size.width - 1), dy = pixel.y() - 0.5 * (size.height - 1);
  const double width = size.width, height = size.height;
  return 4.0 * (dx * dx + dy * dy) / (width * width + height * height);
}

template <typename T>
T vignetting_gain(double r2, const T* v) {
  return T(1) + r2 * (v[0] + r2 * v[1]);
}

// cos^mu of the angle from the axis. Sideways and behind the lamp it stays at a small value, so that a fit that strays
// there finds its way back.
template <typename T>
T beam_falloff(const Eigen::Matrix<T, 3, 1>& axis, const Eigen::Matrix<T, 3, 1>& from_light, const T& mu) {
  using std::pow;
  const T cosine = axis.dot(from_light);
  return cosine > T(0.05) ? pow(cosine, mu) : pow(T(0.05), mu);
}

template <typename T>
T panel_factor(const T& cos_theta_i, const Eigen::Matrix<T, 3, 1>& to_light, const Eigen::Vector3d& normal,
               const Eigen::Vector3d& to_camera, const T* droop) {
  using std::sqrt;
  const double cos_theta_e = to_camera.dot(normal);
  const Eigen::Vector3d view = to_camera - cos_theta_e * normal;
  const Eigen::Matrix<T, 3, 1> light = to_light - cos_theta_i * normal.cast<T>();
  const T cos_phi = light.dot(view.cast<T>()) / (sqrt(light.squaredNorm() + 1e-12) * (view.norm() + 1e-6));
  return T(1) + droop[0] * droop_shape(cos_theta_i, T(cos_theta_e), cos_phi) +
         droop[1] * T(2) * (cos_theta_i - std::cos(8 * M_PI / 180));
}

// Radiance of a patch for a lamp of unit intensity, without vignetting.
template <typename T>
T unit_radiance(const LightPatch& patch, const T* position, const Eigen::Matrix<T, 3, 1>& axis, const T& mu,
                const T* droop, double albedo) {
  using std::sqrt;
  const Eigen::Matrix<T, 3, 1> offset(position[0] - patch.point.x(), position[1] - patch.point.y(),
                                      position[2] - patch.point.z());
  const T d2 = offset.squaredNorm();
  const Eigen::Matrix<T, 3, 1> to_light = offset / sqrt(d2);
  const T cos_theta_i = to_light.dot(patch.normal.template cast<T>());
  return (albedo / M_PI) * cos_theta_i / d2 * beam_falloff<T>(axis, -to_light, mu) *
         panel_factor<T>(cos_theta_i, to_light, patch.normal, patch.to_camera, droop);
}

// Irradiance on a patch by way of a white table at world z = `table_mm`, for a lamp of unit intensity where it is guessed
// (mu = 1): a small correction, not worth following the fit. The panel's own shadow falls behind it and is left out.
inline double table_bounce(const LightPatch& patch, const LightGuess& guess, double table_mm) {
  constexpr int kRings = 12, kTurns = 36;
  const BeamFrame frame(guess);
  const Eigen::Vector3d right = patch.normal.unitOrthogonal(), up = patch.normal.cross(right);
  double sum = 0.0;
  for (int ring = 0; ring < kRings; ++ring)
    for (int turn = 0; turn < kTurns; ++turn) {
      const double sine = std::sqrt((ring + 0.5) / kRings), phi = (turn + 0.5) * 2 * M_PI / kTurns;
      const Eigen::Vector3d direction =
          sine * (std::cos(phi) * right + std::sin(phi) * up) + std::sqrt(1 - sine * sine) * patch.normal;
      if (direction.z() >= 0) continue;
      const Eigen::Vector3d lit = patch.point + (table_mm - patch.point.z()) / direction.z() * direction;
      const Eigen::Vector3d to_light = guess.position - lit;
      const double d2 = to_light.squaredNorm();
      sum += beam_falloff<double>(frame.axis, -to_light / std::sqrt(d2), 1.0) * std::max(0.0, to_light.z()) /
             (d2 * std::sqrt(d2));
    }
  return sum / (kRings * kTurns);
}

}  // namespace calibration

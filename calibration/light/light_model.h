// The radiance of a Spectralon spot under a near light (light.h), written once for double and for automatic
// derivatives.
#pragma once

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>

#include "calibration/light/droop_shape.h"
#include "calibration/light/light_measurements.h"
#include "calibration/sensor/degree.h"

namespace calibration {

// The directions in which a lamp's axis may differ from the guessed one by two small angles (`beam`):
// normalised(axis + beam[0] * right + beam[1] * up).
struct BeamFrame {
  explicit BeamFrame(const LightGuess& guess)
      : axis((guess.aim - guess.position).normalized()), right(axis.unitOrthogonal()), up(axis.cross(right)) {}
  Eigen::Vector3d axis, right, up;

  template <typename T>
  Eigen::Matrix<T, 3, 1> direction(const T* beam) const {
    return (axis.cast<T>() + beam[0] * right.cast<T>() + beam[1] * up.cast<T>()).normalized();
  }
};

// The lamp's relative intensity: cos^mu of the angle from its axis. Sideways and behind the lamp the cosine stays at
// 0.05, so that a fit that strays there finds its way back.
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
         droop[1] * T(2) * (cos_theta_i - std::cos(8 * kDegree));
}

// The radiance of a spot for a lamp of unit intensity, without vignetting.
template <typename T>
T unit_radiance(const PanelSpot& spot, const T* position, const Eigen::Matrix<T, 3, 1>& axis, const T& mu,
                const T* droop, double albedo) {
  using std::sqrt;
  const Eigen::Matrix<T, 3, 1> offset(position[0] - spot.point.x(), position[1] - spot.point.y(),
                                      position[2] - spot.point.z());
  const T d2 = offset.squaredNorm();
  const Eigen::Matrix<T, 3, 1> to_light = offset / sqrt(d2);
  const T cos_theta_i = to_light.dot(spot.normal.template cast<T>());
  return (albedo / std::numbers::pi) * cos_theta_i / d2 * beam_falloff<T>(axis, -to_light, mu) *
         panel_factor<T>(cos_theta_i, to_light, spot.normal, spot.to_camera, droop);
}

// The irradiance on a spot by way of a white table at world z = `table_mm`, from a lamp of unit intensity and mu = 1
// at its guessed place. The correction is small, so it does not follow the fit. The panel's shadow falls behind the
// panel and is left out.
inline double table_bounce(const PanelSpot& spot, const LightGuess& guess, double table_mm) {
  constexpr int kRings = 12, kTurns = 36;
  const BeamFrame frame(guess);
  const Eigen::Vector3d right = spot.normal.unitOrthogonal(), up = spot.normal.cross(right);
  double sum = 0.0;
  for (int ring = 0; ring < kRings; ++ring)
    for (int turn = 0; turn < kTurns; ++turn) {
      const double sine = std::sqrt((ring + 0.5) / kRings), phi = (turn + 0.5) * 2 * std::numbers::pi / kTurns;
      const Eigen::Vector3d direction =
          sine * (std::cos(phi) * right + std::sin(phi) * up) + std::sqrt(1 - sine * sine) * spot.normal;
      if (direction.z() >= 0) continue;
      const Eigen::Vector3d lit = spot.point + (table_mm - spot.point.z()) / direction.z() * direction;
      const Eigen::Vector3d to_light = guess.position - lit;
      const double d2 = to_light.squaredNorm();
      sum += beam_falloff<double>(frame.axis, -to_light / std::sqrt(d2), 1.0) * std::max(0.0, to_light.z()) /
             (d2 * std::sqrt(d2));
    }
  return sum / (kRings * kTurns);
}

}  // namespace calibration

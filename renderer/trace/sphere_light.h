// One spherical light: where a direction meets it, and how to choose directions towards it, uniformly inside its cone.
// A light that surrounds the point is seen in all directions.
#pragma once

#include <cmath>
#include <optional>

#include "renderer/scene/scene.h"

namespace renderer {

// The solid angle (sr) of the light seen from `point`; 4 pi from inside.
double solid_angle(const SphereLight& light, const Eigen::Vector3d& point);
// Distance (mm) to the sphere along a unit direction: the near side from outside, the far side from inside.
inline std::optional<double> distance_to(const SphereLight& light, const Eigen::Vector3d& origin,
                                         const Eigen::Vector3d& direction) {
  const Eigen::Vector3d to_center = light.center - origin;
  const double along = to_center.dot(direction), radius2 = light.radius_mm * light.radius_mm;
  const double half2 = radius2 - (to_center - along * direction).squaredNorm();
  if (half2 < 0) return std::nullopt;
  if (to_center.squaredNorm() <= radius2) return along + std::sqrt(half2);
  if (along < 0) return std::nullopt;
  return along - std::sqrt(half2);
}
// Unit direction towards the light, uniform by solid angle; u in [0, 1)^2.
Eigen::Vector3d direction_to(const SphereLight& light, const Eigen::Vector3d& origin, const Eigen::Vector2f& u);
// The radiance (RGB) that `point` sees, the beam included.
Eigen::Vector3d radiance_at(const SphereLight& light, const Eigen::Vector3d& point);

}  // namespace renderer

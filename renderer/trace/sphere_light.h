// One spherical light: where a direction meets it, and how to choose directions towards it, uniformly inside its cone.
// A light that surrounds the point is seen in all directions.
#pragma once

#include <optional>

#include "renderer/scene/scene.h"

namespace renderer {

// The solid angle (sr) of the light seen from `point`; 4 pi from inside.
double solid_angle(const SphereLight& light, const Eigen::Vector3d& point);
// Distance (mm) to the sphere along a unit direction: the near side from outside, the far side from inside.
std::optional<double> distance_to(const SphereLight& light, const Eigen::Vector3d& origin,
                                  const Eigen::Vector3d& direction);
// Unit direction towards the light, uniform by solid angle; u in [0, 1)^2.
Eigen::Vector3d direction_to(const SphereLight& light, const Eigen::Vector3d& origin, const Eigen::Vector2f& u);
// The radiance (RGB) that `point` sees, the beam included.
Eigen::Vector3d radiance_at(const SphereLight& light, const Eigen::Vector3d& point);

}  // namespace renderer

// One rectangular light, beside sphere_light.h: flat, bright on one side, black and in nobody's way from the other.
//
// Directions towards it are drawn uniformly within its solid angle [Ureña et al. 2013, "An Area-Preserving
// Parametrization for Spherical Rectangles", doi 10.1111/cgf.12151]; where that is so small that rounding would spoil
// it, uniformly over the area instead, which then is as good.
#pragma once

#include <optional>

#include "renderer/scene/scene.h"

namespace renderer {

// The solid angle (sr) of the light seen from `point`; 0 from behind.
double solid_angle(const RectangleLight& light, const Eigen::Vector3d& point);
// Distance (mm) to the bright side along a unit direction.
std::optional<double> distance_to(const RectangleLight& light, const Eigen::Vector3d& origin,
                                  const Eigen::Vector3d& direction);
// Unit direction towards the light, whose solid angle from `origin` must not be 0; u in [0, 1)^2.
Eigen::Vector3d direction_to(const RectangleLight& light, const Eigen::Vector3d& origin, const Eigen::Vector2f& u);
// The radiance (RGB), the same for all points before the light.
inline Eigen::Vector3d radiance_at(const RectangleLight& light, const Eigen::Vector3d&) {
  return light.radiance;
}

}  // namespace renderer

#include "renderer/trace/sphere_light.h"

#include <cmath>
#include <numbers>

namespace renderer {
namespace {

using Eigen::Vector3d;

// 1 - cos of the half angle of the cone around the light; 2 (all directions) from inside.
double one_minus_cos_cone(const SphereLight& light, const Vector3d& origin) {
  const double sin2 = light.radius_mm * light.radius_mm / (light.center - origin).squaredNorm();
  return sin2 < 1 ? sin2 / (1 + std::sqrt(1 - sin2)) : 2.0;
}

}  // namespace

double solid_angle(const SphereLight& light, const Vector3d& point) {
  return 2 * std::numbers::pi * one_minus_cos_cone(light, point);
}

Vector3d direction_to(const SphereLight& light, const Vector3d& origin, const Eigen::Vector2f& u) {
  const Vector3d axis = (light.center - origin).normalized(), side = axis.unitOrthogonal();
  const double one_minus_cos = static_cast<double>(u.x()) * one_minus_cos_cone(light, origin);
  const double sine = std::sqrt(one_minus_cos * (2 - one_minus_cos));
  const double phi = 2 * std::numbers::pi * static_cast<double>(u.y());
  return axis * (1 - one_minus_cos) + sine * (std::cos(phi) * side + std::sin(phi) * axis.cross(side));
}

Vector3d radiance_at(const SphereLight& light, const Vector3d& point) {
  return light.radiance * beam_factor(light, point);
}

}  // namespace renderer

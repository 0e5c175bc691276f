#include "renderer/sphere_lights.h"

#include <cmath>

namespace renderer {
namespace {

using Eigen::Vector3d;

// 1 - cos of the half angle of the cone around the light; 2 (all directions) from inside.
double one_minus_cos_cone(const SphereLight& light, const Vector3d& origin) {
  const double sin2 = light.radius_mm * light.radius_mm / (light.center - origin).squaredNorm();
  return sin2 < 1 ? sin2 / (1 + std::sqrt(1 - sin2)) : 2.0;
}

double luminance(const SphereLight& light) {
  return light.radiance.sum();
}

// Distance to the sphere along a unit direction: the near side from outside, the far side from inside.
std::optional<double> distance_along(const SphereLight& light, const Vector3d& origin, const Vector3d& direction) {
  const Vector3d to_center = light.center - origin;
  const double along = to_center.dot(direction), radius2 = light.radius_mm * light.radius_mm;
  const double half2 = radius2 - (to_center - along * direction).squaredNorm();
  if (half2 < 0) return std::nullopt;
  if (to_center.squaredNorm() <= radius2) return along + std::sqrt(half2);
  if (along < 0) return std::nullopt;
  return along - std::sqrt(half2);
}

Vector3d direction_in_cone(const Vector3d& axis, double one_minus_cos_max, const Eigen::Vector2f& u) {
  const double one_minus_cos = static_cast<double>(u.x()) * one_minus_cos_max;
  const double sine = std::sqrt(one_minus_cos * (2 - one_minus_cos));
  const double phi = 2 * kPi * static_cast<double>(u.y());
  const Vector3d side = axis.unitOrthogonal();
  return axis * (1 - one_minus_cos) + sine * (std::cos(phi) * side + std::sin(phi) * axis.cross(side));
}

}  // namespace

double beam_factor(const SphereLight& light, const Vector3d& point) {
  if (light.beam_exponent == 0.0) return 1.0;
  const double cosine = light.beam_axis.dot((point - light.center).normalized());
  return cosine > 0.0 ? std::pow(cosine, light.beam_exponent) : 0.0;
}

std::optional<LightHit> SphereLights::intersect(const Vector3d& origin, const Vector3d& direction,
                                                bool for_camera) const {
  std::optional<LightHit> nearest;
  for (const SphereLight& light : lights_) {
    if (for_camera && !light.visible) continue;
    const std::optional<double> distance = distance_along(light, origin, direction);
    if (distance && (!nearest || *distance < nearest->distance)) {
      nearest = LightHit{*distance, (light.radiance * beam_factor(light, origin)).cast<float>().array()};
    }
  }
  return nearest;
}

std::optional<Vector3d> SphereLights::sample(const Vector3d& origin, float u_light, const Eigen::Vector2f& u) const {
  if (lights_.empty()) return std::nullopt;
  const SphereLight* chosen = &lights_.back();
  if (lights_.size() > 1) {
    double total = 0;
    for (const SphereLight& light : lights_) total += luminance(light) * one_minus_cos_cone(light, origin);
    double left = static_cast<double>(u_light) * total;
    for (const SphereLight& light : lights_) {
      left -= luminance(light) * one_minus_cos_cone(light, origin);
      if (left < 0) {
        chosen = &light;
        break;
      }
    }
  }
  return direction_in_cone((chosen->center - origin).normalized(), one_minus_cos_cone(*chosen, origin), u);
}

double SphereLights::power(const Vector3d& origin) const {
  double sum = 0;
  for (const SphereLight& light : lights_) sum += 2 * kPi * luminance(light) * one_minus_cos_cone(light, origin);
  return sum;
}

double SphereLights::pdf(const Vector3d& origin, const Vector3d& direction) const {
  double total = 0, met = 0;
  for (const SphereLight& light : lights_) {
    total += luminance(light) * one_minus_cos_cone(light, origin);
    if (distance_along(light, origin, direction)) met += luminance(light);
  }
  return total > 0 ? met / (2 * kPi * total) : 0;
}

}  // namespace renderer

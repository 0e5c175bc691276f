#include "renderer/trace/lights.h"

#include "renderer/trace/rectangle_light.h"
#include "renderer/trace/sphere_light.h"

namespace renderer {
namespace {

using Eigen::Vector3d;
using Light = std::variant<SphereLight, RectangleLight>;

double luminance(const Light& light) {
  return std::visit([](const auto& of) { return of.radiance.sum(); }, light);
}

double power_of(const Light& light, const Vector3d& origin) {
  return std::visit([&](const auto& of) { return of.radiance.sum() * solid_angle(of, origin); }, light);
}

bool is_met(const Light& light, const Vector3d& origin, const Vector3d& direction) {
  return std::visit([&](const auto& of) { return distance_to(of, origin, direction).has_value(); }, light);
}

}  // namespace

Lights::Lights(const Scene& scene) : lights_(scene.lights.begin(), scene.lights.end()) {
  lights_.insert(lights_.end(), scene.rectangles.begin(), scene.rectangles.end());
  if (scene.surroundings) surroundings_.emplace(*scene.surroundings);
}

std::optional<LightHit> Lights::intersect(const Vector3d& origin, const Vector3d& direction, bool for_camera) const {
  std::optional<LightHit> nearest;
  const auto meet = [&](const auto& light) {
    if (for_camera && !light.visible) return;
    const std::optional<double> distance = distance_to(light, origin, direction);
    if (distance && (!nearest || *distance < nearest->distance))
      nearest = LightHit{*distance, radiance_at(light, origin).template cast<float>().array()};
  };
  for (const Light& light : lights_) std::visit(meet, light);
  if (!nearest && surroundings_ && (surroundings_->visible() || !for_camera))
    nearest = LightHit{kSurroundings_mm, surroundings_->radiance(direction)};
  return nearest;
}

std::optional<Vector3d> Lights::sample(const Vector3d& origin, float u_light, const Eigen::Vector2f& u) const {
  if (const SphereLight* lone = lone_sphere()) {
    if (!(lone->radiance.sum() > 0)) return std::nullopt;
    return direction_to(*lone, origin, u);
  }
  double left = size() > 1 ? static_cast<double>(u_light) * power(origin) : 0;
  const Light* chosen = nullptr;
  for (const Light& light : lights_) {
    const double share = power_of(light, origin);
    if (!(share > 0)) continue;
    chosen = &light;
    left -= share;
    if (left < 0) break;
  }
  if (!(left < 0) && surroundings_ && surroundings_->power() > 0) return surroundings_->sample(u);
  if (!chosen) return std::nullopt;
  return std::visit([&](const auto& light) { return direction_to(light, origin, u); }, *chosen);
}

double Lights::power(const Vector3d& origin) const {
  double sum = surroundings_ ? surroundings_->power() : 0;
  for (const Light& light : lights_) sum += power_of(light, origin);
  return sum;
}

double Lights::pdf(const Vector3d& origin, const Vector3d& direction) const {
  if (const SphereLight* lone = lone_sphere())
    return lone->radiance.sum() > 0 && distance_to(*lone, origin, direction) ? 1 / solid_angle(*lone, origin) : 0;
  double sum = surroundings_ ? surroundings_->power() * surroundings_->pdf(direction) : 0;
  for (const Light& light : lights_)
    if (is_met(light, origin, direction)) sum += luminance(light);
  const double all = power(origin);
  return all > 0 ? sum / all : 0;
}

}  // namespace renderer

#include "renderer/lights.h"

#include <algorithm>

namespace renderer {

Lights::Lights(const Scene& scene) : spheres_(scene.lights), rectangles_(scene.rectangles) {
  if (scene.surroundings) surroundings_.emplace(*scene.surroundings);
}

std::optional<LightHit> Lights::intersect(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction,
                                          bool for_camera) const {
  std::optional<LightHit> hit = spheres_.intersect(origin, direction, for_camera);
  const std::optional<LightHit> rectangle = rectangles_.intersect(origin, direction, for_camera);
  if (rectangle && (!hit || rectangle->distance < hit->distance)) hit = rectangle;
  if (!hit && surroundings_ && (surroundings_->visible() || !for_camera))
    hit = LightHit{kSurroundings_mm, surroundings_->radiance(direction)};
  return hit;
}

Lights::Power Lights::power(const Eigen::Vector3d& origin) const {
  return {spheres_.power(origin), rectangles_.power(origin), surroundings_ ? surroundings_->power() : 0.0};
}

std::optional<Eigen::Vector3d> Lights::sample(const Eigen::Vector3d& origin, float u_light,
                                              const Eigen::Vector2f& u) const {
  if (!surroundings_ && rectangles_.size() == 0) return spheres_.sample(origin, u_light, u);
  const Power power = this->power(origin);
  if (!(power.all() > 0)) return std::nullopt;
  const auto of_spheres = static_cast<float>(power.spheres / power.all()),
             of_rectangles = static_cast<float>(power.rectangles / power.all());
  if (u_light < of_spheres) return spheres_.sample(origin, u_light / of_spheres, u);
  if (u_light < of_spheres + of_rectangles || !surroundings_)
    return rectangles_.sample(origin, std::min(1.0f, (u_light - of_spheres) / of_rectangles), u);
  return surroundings_->sample(u);
}

double Lights::pdf(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction) const {
  if (!surroundings_ && rectangles_.size() == 0) return spheres_.pdf(origin, direction);
  const Power power = this->power(origin);
  if (!(power.all() > 0)) return 0;
  double sum = 0;  // of what has no power there, nothing is drawn
  if (power.spheres > 0) sum += power.spheres * spheres_.pdf(origin, direction);
  if (power.rectangles > 0) sum += power.rectangles * rectangles_.pdf(origin, direction);
  if (surroundings_) sum += power.surroundings * surroundings_->pdf(direction);
  return sum / power.all();
}

}  // namespace renderer

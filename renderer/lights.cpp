#include "renderer/lights.h"

namespace renderer {

Lights::Lights(const Scene& scene) : spheres_(scene.lights) {
  if (scene.surroundings) surroundings_.emplace(*scene.surroundings);
}

std::optional<LightHit> Lights::intersect(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction,
                                          bool for_camera) const {
  std::optional<LightHit> hit = spheres_.intersect(origin, direction, for_camera);
  if (!hit && surroundings_ && (surroundings_->visible() || !for_camera))
    hit = LightHit{kSurroundings_mm, surroundings_->radiance(direction)};
  return hit;
}

std::optional<Eigen::Vector3d> Lights::sample(const Eigen::Vector3d& origin, float u_light,
                                              const Eigen::Vector2f& u) const {
  if (!surroundings_) return spheres_.sample(origin, u_light, u);
  const double of_spheres = spheres_.power(origin), all = of_spheres + surroundings_->power();
  const auto share = static_cast<float>(all > 0 ? of_spheres / all : 0.0);
  if (u_light < share) return spheres_.sample(origin, u_light / share, u);
  return surroundings_->sample(u);
}

double Lights::pdf(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction) const {
  if (!surroundings_) return spheres_.pdf(origin, direction);
  const double of_spheres = spheres_.power(origin), all = of_spheres + surroundings_->power();
  const double share = all > 0 ? of_spheres / all : 0.0;
  return share * spheres_.pdf(origin, direction) + (1 - share) * surroundings_->pdf(direction);
}

}  // namespace renderer

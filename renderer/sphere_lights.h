// All spherical lights of a scene as one emitter: what a direction sees, and how to choose directions towards them.
//
// A direction is drawn by choosing a light in proportion to its luminance times solid angle and then uniformly inside
// its cone; `pdf` is the density of that mixture, so lights may overlap, hide each other, or surround the point (a
// surrounding sphere is sampled uniformly over all directions).
#pragma once

#include <optional>
#include <vector>

#include "renderer/scene.h"

namespace renderer {

struct LightHit {
  double distance;  // mm
  Eigen::Array3f radiance;
};

class SphereLights {
 public:
  explicit SphereLights(const std::vector<SphereLight>& lights) : lights_(lights) {}

  // Nearest light along a unit direction; `for_camera` leaves out the lights that cameras do not see.
  std::optional<LightHit> intersect(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction,
                                    bool for_camera) const;
  // Unit direction towards a light, u in [0, 1)^3; none when there is no light.
  std::optional<Eigen::Vector3d> sample(const Eigen::Vector3d& origin, float u_light, const Eigen::Vector2f& u) const;
  std::size_t size() const { return lights_.size(); }
  // Sum over the lights of R + G + B times the solid angle (sr) that each fills seen from there; beams are left out.
  double power(const Eigen::Vector3d& origin) const;
  // Density of `sample` per solid angle.
  double pdf(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction) const;

 private:
  std::vector<SphereLight> lights_;
};

}  // namespace renderer

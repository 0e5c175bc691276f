// All rectangular lights of a scene as one emitter, beside sphere_lights.h: flat, bright on one side, black and in
// nobody's way from the other.
//
// A direction is drawn by choosing a light in proportion to its luminance times solid angle, and then uniformly within
// that solid angle [Ureña et al. 2013, "An Area-Preserving Parametrization for Spherical Rectangles", doi
// 10.1111/cgf.12151]; where it is so small that rounding would spoil that, uniformly over the area instead, which then
// is as good. `pdf` is the density of that mixture, so lights may overlap and hide each other.
#pragma once

#include <optional>
#include <vector>

#include "renderer/scene.h"
#include "renderer/sphere_lights.h"

namespace renderer {

// In sr, seen from `point`; 0 from behind.
double solid_angle(const RectangleLight& light, const Eigen::Vector3d& point);

class RectangleLights {
 public:
  explicit RectangleLights(const std::vector<RectangleLight>& lights) : lights_(lights) {}

  // Nearest light whose bright side is met along a unit direction; `for_camera` leaves out those that cameras do not
  // see.
  std::optional<LightHit> intersect(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction,
                                    bool for_camera) const;
  // Unit direction towards a light, u in [0, 1)^3; none where no light is seen.
  std::optional<Eigen::Vector3d> sample(const Eigen::Vector3d& origin, float u_light, const Eigen::Vector2f& u) const;
  std::size_t size() const { return lights_.size(); }
  // Sum over the lights of R + G + B times the solid angle (sr) that each fills seen from there.
  double power(const Eigen::Vector3d& origin) const;
  // Density of `sample` per solid angle.
  double pdf(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction) const;

 private:
  std::vector<RectangleLight> lights_;
};

}  // namespace renderer

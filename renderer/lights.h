// All lights of a scene as one emitter: its spheres and rectangles, and behind them its surroundings.
//
// A direction is drawn from the spheres, from the rectangles or from the surroundings in proportion to luminance times
// solid angle; `pdf` is the density of that mixture, so lights may overlap and hide each other.
#pragma once

#include <optional>

#include "renderer/environment_map.h"
#include "renderer/rectangle_lights.h"
#include "renderer/sphere_lights.h"

namespace renderer {

class Lights {
 public:
  // Errors: those of EnvironmentMap.
  explicit Lights(const Scene& scene);

  // Nearest light along a unit direction; `for_camera` leaves out the lights that cameras do not see. Surroundings are
  // kSurroundings_mm away.
  std::optional<LightHit> intersect(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction,
                                    bool for_camera) const;
  // Unit direction towards a light, u in [0, 1)^3; none when there is no light, or none that shines there.
  std::optional<Eigen::Vector3d> sample(const Eigen::Vector3d& origin, float u_light, const Eigen::Vector2f& u) const;
  // Density of `sample` per solid angle.
  double pdf(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction) const;
  std::size_t size() const { return spheres_.size() + rectangles_.size() + (surroundings_ ? 1 : 0); }

  static constexpr double kSurroundings_mm = 1e9;

 private:
  struct Power {
    double spheres = 0, rectangles = 0, surroundings = 0;
    double all() const { return spheres + rectangles + surroundings; }
  };
  Power power(const Eigen::Vector3d& origin) const;

  SphereLights spheres_;
  RectangleLights rectangles_;
  std::optional<EnvironmentMap> surroundings_;
};

}  // namespace renderer

// All lights of a scene as one emitter: its spheres and rectangles, and behind them its surroundings.
//
// A direction is drawn by choosing a light in proportion to its luminance times solid angle and then uniformly inside
// that; `pdf` is the density of that mixture, so lights may overlap, hide each other, or surround the point.
#pragma once

#include <optional>
#include <variant>
#include <vector>

#include "renderer/scene/environment_map.h"
#include "renderer/scene/scene.h"

namespace renderer {

struct LightHit {
  double distance;  // mm
  Eigen::Array3f radiance;
};

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
  // Sum over the lights of R + G + B times the solid angle (sr) that each fills seen from there; beams are left out.
  double power(const Eigen::Vector3d& origin) const;
  // Density of `sample` per solid angle.
  double pdf(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction) const;
  // Whether all of them are so far away that a direction is as good from one place as from another.
  bool at_infinity() const { return lights_.empty(); }
  std::size_t size() const { return lights_.size() + (surroundings_ ? 1 : 0); }

  static constexpr double kSurroundings_mm = 1e9;

 private:
  // The only light, where it is a sphere: a bench's lamp. Nothing is chosen then.
  const SphereLight* lone_sphere() const {
    return lights_.size() == 1 && !surroundings_ ? std::get_if<SphereLight>(&lights_.front()) : nullptr;
  }

  std::vector<std::variant<SphereLight, RectangleLight>> lights_;
  std::optional<EnvironmentMap> surroundings_;
};

}  // namespace renderer

// A ray's way among the fibers of a thread (renderer/scattering/bundle.h).
//
// Where a ray enters the thread, the section is taken to go on straight along the tangent, and a bundle is drawn into
// it: round sections get one of the ready bundles turned by a random angle, flat ones one that is mirrored at random.
// The ray meets this bundle until it leaves the thread; whatever enters the thread next meets another.
#pragma once

#include <Eigen/Core>
#include <optional>

#include "renderer/picture/sampler.h"
#include "renderer/scattering/bundle.h"
#include "renderer/trace/ray_hit.h"

namespace renderer {

class BundleWalk {
 public:
  // `entry`: where the thread was met.
  BundleWalk(const BundleSections& sections, const CurvePoint& entry, Sampler& sampler);

  // The fiber that the ray meets first. The ray starts anywhere in the thread, and not on a fiber but the one found
  // last, which it leaves. None when it leaves the thread without meeting one.
  std::optional<SurfaceHit> next(const Ray& ray);

 private:
  Eigen::Vector2f in_section(const Eigen::Vector3f& v) const { return {v.dot(x_), v.dot(y_)}; }

  const CircleGrid* fibers_;
  Eigen::Vector3f axis_, tangent_;  // a point of the axis; the direction of all fibers
  Eigen::Vector3f x_, y_;           // of the section that the bundle was drawn in, in units of the fiber's radius
  float fiber_radius_;              // mm
  std::uint32_t curve_set_;
  int fiber_ = -1;  // found last
};

}  // namespace renderer

// A ray's way among the fibers of a thread (renderer/scattering/bundle.h).
//
// Where a ray enters the thread, a bundle is drawn into its section: round sections get one of the ready bundles turned
// by a random angle, flat ones one that is mirrored at random. The ray meets this bundle until it leaves the thread;
// whatever enters the thread next meets another.
//
// Fibers keep their places in the section while the thread bends. The section goes on straight along the tangent for a
// part of a radius; there, and at every fiber that is met, it is set up anew across the thread's axis.
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
  // Whether a place near those met so far lies in the thread.
  bool contains(const Eigen::Vector3f& place);

 private:
  Eigen::Vector2f in_section(const Eigen::Vector3f& v) const { return {v.dot(x_), v.dot(y_)}; }
  // Sets the section up across the axis where `place` is.
  void move_to(const Eigen::Vector3f& place);

  const CircleGrid* fibers_;
  CurveAxis line_;
  Eigen::Vector3f met_;             // the axis where the thread was met
  float t_ = 0;                     // where the section is, on line_
  Eigen::Vector3f axis_, tangent_;  // there: a point of the axis, the direction of all fibers
  float reach_, height_;            // half the section's longer and shorter axis, in units of the fiber's radius
  Eigen::Vector3f x_, y_;           // of the section that the bundle was drawn in, in units of the fiber's radius
  float fiber_radius_;              // mm
  std::uint32_t curve_set_;
  int fiber_ = -1;  // found last
};

}  // namespace renderer

#include "renderer/trace/bundle_walk.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace renderer {
namespace {

using Eigen::Vector2f;
using Eigen::Vector3f;

constexpr float kRound = 1.01f;        // up to this flatness a section counts as round
constexpr float kLeastCosine = 1e-4f;  // of a ray's inclination, below which it flies along the fibers
// How far below a fiber's surface scattered rays start, in radii.
constexpr float kStartDepth = 1e-3f;

// The ellipse of all points x a + y b with x^2 + y^2 = 1.
struct Ellipse {
  float area;      // over pi
  float flatness;  // how many times as wide as high it is
  Vector2f wide;   // unit, along the longer axis

  Ellipse(const Vector2f& a, const Vector2f& b) {
    const Vector2f stretch = 0.5f * Vector2f(a.x() * a.x() + b.x() * b.x() - a.y() * a.y() - b.y() * b.y(),
                                             2 * (a.x() * a.y() + b.x() * b.y()));
    const float mean = 0.5f * (a.squaredNorm() + b.squaredNorm()), half = stretch.norm();
    const float longer2 = mean + half;  // squared half axis
    area = std::abs(a.x() * b.y() - a.y() * b.x());
    flatness = area > 0 ? longer2 / area : 1;
    const float angle = half > 0 ? 0.5f * std::atan2(stretch.y(), stretch.x()) : 0;
    wide = {std::cos(angle), std::sin(angle)};
  }
};

}  // namespace

BundleWalk::BundleWalk(const BundleSections& sections, const CurvePoint& entry, Sampler& sampler)
    : axis_(entry.position - entry.out), tangent_(entry.tangent), curve_set_(entry.curve_set) {
  const Vector2f u = sampler.next_2d();
  const int draw = std::min(static_cast<int>(u.x() * static_cast<float>(sections.draws())), sections.draws() - 1);
  const Vector3f across = entry.normal.cross(tangent_);
  const Ellipse section({entry.side.dot(across), entry.side.dot(entry.normal)},
                        {entry.out.dot(across), entry.out.dot(entry.normal)});
  fiber_radius_ = static_cast<float>(sections.radius_ratio()) * std::sqrt(section.area);
  Vector2f wide, high;
  if (section.flatness < kRound) {
    const float angle = 2 * std::numbers::pi_v<float> * u.y();
    wide = {std::cos(angle), std::sin(angle)}, high = {-wide.y(), wide.x()};
    fibers_ = &sections.section(1, draw);
  } else {
    const int mirrored = static_cast<int>(u.y() * 4);
    wide = mirrored & 1 ? -section.wide : section.wide;
    high = mirrored & 2 ? Vector2f(wide.y(), -wide.x()) : Vector2f(-wide.y(), wide.x());
    fibers_ = &sections.section(static_cast<double>(section.flatness), draw);
  }
  x_ = (wide.x() * across + wide.y() * entry.normal) / fiber_radius_;
  y_ = (high.x() * across + high.y() * entry.normal) / fiber_radius_;
}

std::optional<SurfaceHit> BundleWalk::next(const Ray& ray) {
  const Vector2f flight = in_section(ray.direction);
  const float speed = flight.norm();  // fiber radii per mm
  if (!(speed * fiber_radius_ > kLeastCosine)) return std::nullopt;
  const Eigen::Vector2d origin = in_section(ray.origin - axis_).cast<double>(),
                        direction = flight.cast<double>() / speed;
  const CircleHit hit = fibers_->nearest(origin, direction, fiber_);
  if (hit.circle < 0) return std::nullopt;
  fiber_ = hit.circle;
  const Vector2f outward = (origin + hit.distance * direction - fibers_->center(fiber_)).cast<float>();
  CurvePoint point;
  point.curve_set = curve_set_;
  point.tangent = tangent_;
  const float scale = fiber_radius_ * fiber_radius_;  // x_ and y_ are as long as the inverse of the radius
  point.normal = ((outward.x() * x_ + outward.y() * y_) * scale).normalized();
  point.out = fiber_radius_ * (1 - kStartDepth) * point.normal;
  point.side = point.out.cross(tangent_);
  const auto distance = static_cast<float>(hit.distance) / speed;
  point.position = ray.origin + distance * ray.direction - kStartDepth * fiber_radius_ * point.normal;
  return SurfaceHit{distance, point};
}

}  // namespace renderer

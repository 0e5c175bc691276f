#include "renderer/trace/bundle_walk.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

namespace renderer {
namespace {

using Eigen::Vector2f;
using Eigen::Vector3f;

constexpr float kRound = 1.01f;        // up to this flatness a section counts as round
constexpr float kLeastCosine = 1e-4f;  // of a ray's inclination, below which it flies along the fibers
// How far along the axis a section counts as straight, in its longer half axes.
constexpr float kStraight = 0.25f;
constexpr int kMostSteps = 64;  // of them that a ray goes without meeting a fiber, before it counts as having left

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
    : line_(entry.axis),
      met_(entry.position - entry.out),
      axis_(met_),
      tangent_(entry.tangent),
      curve_set_(entry.curve_set) {
  const Vector2f u = sampler.next_2d();
  const int draw = std::min(static_cast<int>(u.x() * static_cast<float>(sections.draws())), sections.draws() - 1);
  const Vector3f across = entry.normal.cross(tangent_);
  const Ellipse section({entry.side.dot(across), entry.side.dot(entry.normal)},
                        {entry.out.dot(across), entry.out.dot(entry.normal)});
  fiber_radius_ = static_cast<float>(sections.radius_ratio()) * std::sqrt(section.area);
  reach_ = std::sqrt(section.flatness * section.area) / fiber_radius_;
  height_ = reach_ / section.flatness;
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

void BundleWalk::move_to(const Vector3f& place) {
  constexpr int kIterations = 2;
  CurveAxis::Place here = line_.at(t_);
  for (int i = 0; i < kIterations; ++i) {
    t_ += (place - met_ - here.offset).dot(here.derivative) / here.derivative.squaredNorm();
    here = line_.at(t_);
  }
  axis_ = met_ + here.offset;
  const Vector3f along = here.derivative.normalized(), tangent = along.dot(tangent_) < 0 ? Vector3f(-along) : along;
  const auto turn = Eigen::Quaternionf::FromTwoVectors(tangent_, tangent);
  x_ = turn * x_, y_ = turn * y_;
  tangent_ = tangent;
}

bool BundleWalk::contains(const Vector3f& place) {
  move_to(place);
  return in_section(place - axis_).cwiseQuotient(Vector2f(reach_, height_)).squaredNorm() < 1;
}

std::optional<SurfaceHit> BundleWalk::next(const Ray& ray) {
  const float step = kStraight * reach_ * fiber_radius_;  // mm along the axis
  Vector3f origin = ray.origin;
  float before = 0;
  for (int steps = 0; steps < kMostSteps; ++steps) {
    const Vector2f flight = in_section(ray.direction);
    const float speed = flight.norm();  // fiber radii per mm
    const float along = std::abs(ray.direction.dot(tangent_)), straight = along > 0 ? step / along : 1e30f;
    CircleHit hit;
    Eigen::Vector2d from, direction;
    if (speed * fiber_radius_ > kLeastCosine) {
      from = in_section(origin - axis_).cast<double>(), direction = flight.cast<double>() / speed;
      hit = fibers_->nearest(from, direction, fiber_);
    }
    const float distance = static_cast<float>(hit.distance) / speed;
    if (hit.circle < 0 || distance > straight) {
      origin += straight * ray.direction;
      before += straight;
      if (in_section(origin - axis_).norm() > reach_) return std::nullopt;
      move_to(origin);
      continue;
    }
    fiber_ = hit.circle;
    const Vector2f outward = (from + hit.distance * direction - fibers_->center(fiber_)).cast<float>();
    move_to(origin + distance * ray.direction);
    const float scale = fiber_radius_ * fiber_radius_;  // x_ and y_ are as long as the inverse of the radius
    const Vector2f place = fibers_->center(fiber_).cast<float>() + (1 - kStartDepth) * outward;
    CurvePoint point;
    point.curve_set = curve_set_;
    point.tangent = tangent_;
    point.normal = ((outward.x() * x_ + outward.y() * y_) * scale).normalized();
    point.out = fiber_radius_ * (1 - kStartDepth) * point.normal;
    point.side = point.out.cross(point.tangent);
    point.position = axis_ + (place.x() * x_ + place.y() * y_) * scale;
    return SurfaceHit{before + distance, point};
  }
  return std::nullopt;
}

}  // namespace renderer

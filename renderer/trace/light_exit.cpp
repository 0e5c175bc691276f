#include "renderer/trace/light_exit.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "renderer/scattering/exit_offsets.h"

namespace renderer {
namespace {

using Eigen::Vector2f;
using Eigen::Vector3f;
constexpr float kPi = std::numbers::pi_v<float>;

// The share of places that near() draws anywhere on the section, so that it draws every place from which the lamp is
// seen.
constexpr float kAnywhere = 0.02f;
// The least chance with which near() draws either side of the thread under ThreadExit::far_side.
constexpr float kLeastSide = 0.02f;
constexpr float kSideSlope = 5;  // how quickly that chance changes with the sine of the direction above the surface
// How far along a thread light comes for each step across it, at most: further on yarns bend away.
constexpr float kMostSlope = 0.5f;

}  // namespace

float offset_in_section(const CurvePoint& point, const Vector3f& wo) {
  const Vector3f across = point.tangent.cross(wo);
  const float half_width = std::hypot(point.side.dot(across), point.out.dot(across));
  return half_width > 0 ? std::clamp(-point.out.dot(across) / half_width, -1.0f, 1.0f) : 0.0f;
}

ThreadExits::ThreadExits(ThreadExit rule, const CurvePoint& point, const Vector3f& wo)
    : rule_(rule), point_(&point), side_(point.normal.cross(point.tangent)), out_(point.normal) {
  offset_in_ = offset_in_section(point, wo);
  came_from_ = {wo.dot(side_), wo.dot(out_)};
  const float along = -wo.dot(point.tangent), across = std::sqrt(std::max(0.0f, 1 - along * along));
  slope_ = rule == ThreadExit::wandering ? std::clamp(along / std::max(across, 1e-6f), -kMostSlope, kMostSlope) : 0.0f;
}

ThreadExits::Seen ThreadExits::seen_from(const Vector3f& direction) const {
  const Vector3f across = point_->tangent.cross(direction);
  const float cosine = across.norm();
  if (!(cosine > 0)) return {.outward = Vector2f::UnitY(), .across = -Vector2f::UnitX()};
  Vector2f offsets(point_->side.dot(across), point_->out.dot(across));
  const float length = offsets.norm();
  offsets /= length;
  return {.outward = {offsets.y(), -offsets.x()}, .across = offsets, .half_width = length / cosine, .cosine = cosine};
}

float ThreadExits::azimuth_of(const Vector3f& wi) const {
  const float side = wi.dot(side_), out = wi.dot(out_);
  return std::atan2(came_from_.x() * out - came_from_.y() * side, came_from_.x() * side + came_from_.y() * out);
}

LightExit ThreadExits::at_entry(float drawn) const {
  return {.place = point_->position, .on_circle = Vector2f::UnitY(), .drawn = drawn, .at_entry = true};
}

LightExit ThreadExits::at(const Vector2f& on_circle, float drawn) const {
  const Vector3f from_entry = on_circle.x() * point_->side + (on_circle.y() - 1) * point_->out;
  return {.place = point_->position + from_entry + (slope_ * from_entry.norm()) * point_->tangent,
          .on_circle = on_circle,
          .drawn = drawn,
          .at_entry = false};
}

float ThreadExits::density(const Vector2f& on_circle, const Seen& seen, const Vector3f& wi) const {
  const float facing = on_circle.dot(seen.outward);
  if (!(facing > 0)) return 0;
  if (rule_ == ThreadExit::far_side) return 0.5f * facing;
  return facing * simulated_exit_offsets().density(offset_in_, azimuth_of(wi), on_circle.dot(seen.across));
}

LightExit ThreadExits::toward(const Vector3f& wi, Sampler& sampler) const {
  const Seen seen = seen_from(wi);
  if (rule_ == ThreadExit::entry_point || seen.cosine == 0 || (rule_ == ThreadExit::far_side && faces_entry(seen)))
    return at_entry(0);
  const float u = sampler.next_1d();
  const float offset =
      rule_ == ThreadExit::far_side ? 2 * u - 1 : simulated_exit_offsets().sample(offset_in_, azimuth_of(wi), u);
  return at(std::sqrt(std::max(0.0f, 1 - offset * offset)) * seen.outward + offset * seen.across, 0);
}

LightExit ThreadExits::near(const Vector3f& about, Sampler& sampler) const {
  if (rule_ == ThreadExit::entry_point) return at_entry(1);
  const Seen seen = seen_from(about);
  if (seen.cosine == 0) return at_entry(1);
  float u = sampler.next_1d(), rest = 1;
  if (rule_ == ThreadExit::far_side) {
    const float entry = std::clamp(0.5f + kSideSlope * seen.outward.y(), kLeastSide, 1 - kLeastSide);
    if (u < entry) return at_entry(entry);
    rest = 1 - entry;
    u = std::min((u - entry) / rest, 1.0f);
  }
  Vector2f place;
  if (u < kAnywhere) {
    const float angle = 2 * kPi * u / kAnywhere;
    place = {std::cos(angle), std::sin(angle)};
  } else {
    u = std::min((u - kAnywhere) / (1 - kAnywhere), 0x1.fffffep-1f);
    const float offset =
        rule_ == ThreadExit::far_side ? 2 * u - 1 : simulated_exit_offsets().sample(offset_in_, azimuth_of(about), u);
    place = std::sqrt(std::max(0.0f, 1 - offset * offset)) * seen.outward + offset * seen.across;
  }
  return at(place, rest * (kAnywhere / (2 * kPi) + (1 - kAnywhere) * density(place, seen, about)));
}

float ThreadExits::share(const LightExit& exit, const Vector3f& wi) const {
  if (rule_ == ThreadExit::entry_point || exit.drawn == 0) return 1;
  const Seen seen = seen_from(wi);
  if (rule_ == ThreadExit::far_side && faces_entry(seen) != exit.at_entry) return 0;
  if (exit.at_entry) return 1 / exit.drawn;
  return density(exit.on_circle, seen, wi) / exit.drawn;
}

LeavingRay ThreadExits::ray(const LightExit& exit, const Vector3f& wi) const {
  const Seen seen = seen_from(wi);
  const float facing = exit.on_circle.dot(seen.outward);
  if (rule_ == ThreadExit::entry_point || !(facing > 0) || !(seen.half_width > 0)) return {{exit.place, wi}, 0};
  // Half the chord through the ellipse, but not further than half its mean width along threads.
  const float area = point_->side.cross(point_->out).norm();
  const float half_chord = facing * area / seen.half_width;
  const float lead = std::min(half_chord / seen.cosine, std::max(half_chord, std::sqrt(area)));
  return {{exit.place - lead * wi, wi}, lead};
}

}  // namespace renderer

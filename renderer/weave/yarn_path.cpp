#include "renderer/weave/yarn_path.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace renderer {
namespace {

// The least crown of the *crossing* system that lets a yarn pass between two neighbours of it: their centres, one
// pitch apart and at +- crown, must be two contact distances from each other.
double least_crossing_crown(double pitch_mm, double contact_mm) {
  return std::sqrt(std::max(0.0, contact_mm * contact_mm - pitch_mm * pitch_mm / 4));
}

double bending_weight(const YarnSystem& own, double pitch_along_mm) {
  return std::pow(pitch_along_mm, 3) / bending_of(own);
}

// The half-wave whose arc has the share kLeastArcShare: with straight part = q * arc and a radius of 1 it ends at
// (sin t + q t cos t, 1 - cos t + q t sin t), whose slope from the crown grows with the angle t and must be that of
// the middle.
HalfWave rounded_half_wave(double pitch_mm, double crown_mm) {
  constexpr double q = 1 / kLeastArcShare - 1;
  const double slope = 2 * crown_mm / pitch_mm;
  const auto across = [](double t) { return std::sin(t) + q * t * std::cos(t); };
  const auto drop = [](double t) { return 1 - std::cos(t) + q * t * std::sin(t); };
  double low = 0, high = std::numbers::pi / 2;
  for (int step = 0; step < 60; ++step) {
    const double middle = (low + high) / 2;
    (drop(middle) < slope * across(middle) ? low : high) = middle;
  }
  const double radius = pitch_mm / 2 / across(high);
  return {.crown_mm = crown_mm, .radius_mm = radius, .angle_rad = high, .straight_mm = q * radius * high};
}

}  // namespace

CrownHeights split_heights(const YarnSystem& warp, const YarnSystem& weft) {
  const double contact = (warp.diameter_mm + weft.diameter_mm) / 2;
  const double easy_warp = bending_weight(warp, weft.pitch_mm), easy_weft = bending_weight(weft, warp.pitch_mm);
  const double wanted = contact * easy_warp / (easy_warp + easy_weft);
  const double low = least_crossing_crown(warp.pitch_mm, contact);             // the weft crosses warp ends
  const double high = contact - least_crossing_crown(weft.pitch_mm, contact);  // the warp crosses weft picks
  const double crown = low <= high ? std::clamp(wanted, low, high) : std::clamp((low + high) / 2, 0.0, contact);
  return {.warp_mm = crown, .weft_mm = contact - crown};
}

Eigen::Vector2d HalfWave::at(double arc_length_mm) const {
  const double turned = std::min(arc_length_mm / radius_mm, angle_rad);
  const double onward = std::max(0.0, arc_length_mm - radius_mm * angle_rad);
  return {radius_mm * std::sin(turned) + onward * std::cos(turned),
          crown_mm - radius_mm * (1 - std::cos(turned)) - onward * std::sin(turned)};
}

// The path is symmetric about the middle M = (pitch / 2, 0). The crossing yarn's centre is (0, -crossing_crown) when
// this yarn passes above it; the straight part is the tangent from M to the circle of the contact distance round that
// centre.
HalfWave taut_half_wave(double pitch_mm, double crown_mm, double crossing_crown_mm) {
  const double half = pitch_mm / 2, contact = crown_mm + crossing_crown_mm;
  const double to_middle = std::hypot(half, crossing_crown_mm);
  if (to_middle >= contact) {
    const double angle = std::asin(contact / to_middle) - std::atan2(crossing_crown_mm, half);
    return {.crown_mm = crown_mm,
            .radius_mm = contact,
            .angle_rad = angle,
            .straight_mm = std::sqrt((to_middle - contact) * (to_middle + contact))};
  }
  const double angle = 2 * std::atan2(crown_mm, half);  // two arcs that meet in M
  return {.crown_mm = crown_mm, .radius_mm = half / std::sin(angle), .angle_rad = angle, .straight_mm = 0};
}

HalfWave half_wave(double pitch_mm, double crown_mm, double crossing_crown_mm) {
  const HalfWave taut = taut_half_wave(pitch_mm, crown_mm, crossing_crown_mm);
  if (taut.radius_mm * taut.angle_rad >= kLeastArcShare * taut.length_mm()) return taut;
  return rounded_half_wave(pitch_mm, crown_mm);
}

std::vector<Eigen::Vector2d> yarn_path(const std::vector<bool>& on_top, double pitch_mm, const HalfWave& wave,
                                       int points_per_crossing) {
  const std::size_t crossings = on_top.size();
  std::vector<Eigen::Vector2d> points;
  for (std::size_t i = 0; i < crossings; ++i) {
    const double crossing = (static_cast<double>(i) + 0.5) * pitch_mm, side = on_top[i] ? 1 : -1;
    for (int step = -points_per_crossing / 2; step < points_per_crossing / 2; ++step) {
      const bool neighbour = on_top[(i + (step < 0 ? crossings - 1 : 1)) % crossings];
      const double fraction = 2.0 * std::abs(step) / points_per_crossing;  // 0 at the crossing, 1 at the middle
      const Eigen::Vector2d shape = neighbour == on_top[i] ? Eigen::Vector2d(fraction * pitch_mm / 2, wave.crown_mm)
                                                           : wave.at(fraction * wave.length_mm());
      points.push_back({crossing + (step < 0 ? -shape.x() : shape.x()), side * shape.y()});
    }
  }
  return points;
}

}  // namespace renderer

#include "renderer/scattering/fiber_bundle.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <utility>

namespace renderer {
namespace {

// A number in [0, 1). The standard distributions differ between libraries, the engine does not.
double uniform(std::mt19937_64& engine) {
  return static_cast<double>(engine() >> 11) * 0x1p-53;
}

// Whether the circle lies inside the ellipse with these half axes: no tangent of the ellipse cuts it.
bool lies_inside(const Eigen::Vector2d& center, double radius, const Eigen::Vector2d& half_axes) {
  constexpr int kTangents = 256;
  for (int i = 0; i < kTangents; ++i) {
    const double angle = 2 * std::numbers::pi * i / kTangents;
    const Eigen::Vector2d outward(std::cos(angle), std::sin(angle));
    if (center.dot(outward) + radius > half_axes.cwiseProduct(outward).norm()) return false;
  }
  return true;
}

}  // namespace

std::vector<Eigen::Vector2d> pack_fibers(double thread_radius, double fiber_radius, double min_gap, int max_attempts,
                                         int max_fibers, std::uint64_t seed, FiberPlacement placement,
                                         double flatness) {
  std::vector<Eigen::Vector2d> centers;
  const Eigen::Vector2d half_axes(thread_radius * std::sqrt(flatness), thread_radius / std::sqrt(flatness)),
      reach = half_axes.array() - fiber_radius;  // of centres, and where the section is flat a little beyond
  if (reach.minCoeff() < 0) return centers;
  const double apart = 2 * fiber_radius + min_gap;
  std::mt19937_64 engine(seed);
  for (int attempt = 0; attempt < max_attempts && std::cmp_less(centers.size(), max_fibers); ++attempt) {
    const double u = uniform(engine);
    const double share = placement == FiberPlacement::area_uniform ? std::sqrt(u) : u;
    const double angle = 2 * std::numbers::pi * uniform(engine);
    const Eigen::Vector2d center(reach.x() * share * std::cos(angle), reach.y() * share * std::sin(angle));
    if (flatness != 1 && !lies_inside(center, fiber_radius, half_axes)) continue;
    const bool free = std::none_of(centers.begin(), centers.end(),
                                   [&](const Eigen::Vector2d& other) { return (other - center).norm() < apart; });
    if (free) centers.push_back(center);
  }
  return centers;
}

}  // namespace renderer

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

}  // namespace

std::vector<Eigen::Vector2d> pack_fibers(double thread_radius, double fiber_radius, double min_gap, int max_attempts,
                                         int max_fibers, std::uint64_t seed, FiberPlacement placement) {
  std::vector<Eigen::Vector2d> centers;
  const double reach = thread_radius - fiber_radius;
  if (reach < 0) return centers;
  const double apart = 2 * fiber_radius + min_gap;
  std::mt19937_64 engine(seed);
  for (int attempt = 0; attempt < max_attempts && std::cmp_less(centers.size(), max_fibers); ++attempt) {
    const double u = uniform(engine);
    const double radius = reach * (placement == FiberPlacement::area_uniform ? std::sqrt(u) : u);
    const double angle = 2 * std::numbers::pi * uniform(engine);
    const Eigen::Vector2d center(radius * std::cos(angle), radius * std::sin(angle));
    const bool free = std::none_of(centers.begin(), centers.end(),
                                   [&](const Eigen::Vector2d& other) { return (other - center).norm() < apart; });
    if (free) centers.push_back(center);
  }
  return centers;
}

}  // namespace renderer

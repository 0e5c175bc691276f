#include "renderer/scene/fiber_detail.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "renderer/scattering/random_stream.h"

namespace renderer {
namespace {

using Eigen::Vector3d;

constexpr double kTwoPi = 2 * std::numbers::pi;

// How far a fiber runs on the surface before it has another direction and shade, in its widths.
constexpr double kRun = 40;
constexpr double kLift = 0.3;  // standard deviation of lifts over that of turns: fibers lie on the surface

// Three numbers of mean 0 and standard deviation 1 that belong to a fiber and a place along it; sums of uniform
// numbers, which have no far tails.
std::array<double, 3> deviations(std::uint64_t fiber, std::int64_t run) {
  RandomStream random(fiber, static_cast<std::uint64_t>(run));
  std::array<double, 3> found{};
  for (double& value : found) value = 2 * (random.uniform() + random.uniform() + random.uniform() - 1.5);
  return found;
}

}  // namespace

FiberAt fiber_at(const FiberDetail& detail, double along_mm, double azimuth_rad, double radius_mm, std::uint64_t yarn) {
  const double round_mm = kTwoPi * radius_mm;
  const double fibers = std::max(3.0, std::round(round_mm / detail.width_mm));
  // The fiber's number is where its helix begins.
  const double place = azimuth_rad / kTwoPi - along_mm * std::tan(detail.twist_rad) / round_mm;
  const auto number = static_cast<std::uint64_t>((place - std::floor(place)) * fibers);
  const std::uint64_t fiber = mixed_bits(detail.seed + mixed_bits(yarn * 4099 + number));
  // Runs of neighbouring fibers begin at different places.
  const double at = along_mm / (kRun * detail.width_mm) + static_cast<double>(fiber >> 40) * 0x1p-24;
  const double run = std::floor(at), part = at - run, share = part * part * (3 - 2 * part);
  const std::array<double, 3> here = deviations(fiber, static_cast<std::int64_t>(run)),
                              next = deviations(fiber, static_cast<std::int64_t>(run) + 1);
  const double scale = 1 / std::hypot(1 - share, share);  // a mean of two numbers deviates less
  const auto between = [&](std::size_t i) { return scale * ((1 - share) * here.at(i) + share * next.at(i)); };
  return {.turn_rad = static_cast<float>(detail.twist_rad + detail.spread_rad * between(0)),
          .lift_rad = static_cast<float>(kLift * detail.spread_rad * between(1)),
          .shade = static_cast<float>(std::max(0.0, 1 + detail.shade * between(2)))};
}

namespace {

Vector3d random_unit(RandomStream& random) {
  const double z = 2 * random.uniform() - 1, angle = kTwoPi * random.uniform(), r = std::sqrt(1 - z * z);
  return {r * std::cos(angle), r * std::sin(angle), z};
}

// One fiber: it leaves the yarn at t along its axis and outwards, and keeps its direction for about a third of its
// length.
std::vector<Vector3d> walk_of(const PeriodicSpline& line, double t, double radius_mm, const Flyaways& f,
                              RandomStream& random) {
  constexpr int kSteps = 6;
  constexpr double kTurning = 0.55, kWeight = 0.12;
  const Vector3d tangent = spline_value(line, t, 1).normalized(), side = tangent.unitOrthogonal(),
                 up = tangent.cross(side);
  const double angle = kTwoPi * random.uniform();
  const Vector3d outwards = std::cos(angle) * side + std::sin(angle) * up;
  Vector3d direction = ((random.uniform() < 0.5 ? -1 : 1) * tangent + (0.4 + random.uniform()) * outwards).normalized();
  std::vector<Vector3d> points{spline_value(line, t) + 0.6 * radius_mm * outwards};
  // Lengths are spread as those of broken ends are: many short ones.
  const double step_mm = f.length_mm * (0.35 + 1.3 * random.uniform() * random.uniform()) / kSteps;
  for (int k = 0; k < kSteps; ++k) {
    points.push_back(points.back() + step_mm * direction);
    direction = (direction + kTurning * random_unit(random)).normalized();
    // Back towards the cloth: neighbouring yarns and the iron have pressed it down.
    direction.z() -= kWeight * (points.back().z() > 0 ? 1 : -1);
    direction.normalize();
  }
  return points;
}

}  // namespace

FlyawayCurves flyaway_curves(const YarnPatch& patch, const Flyaways& flyaways) {
  FlyawayCurves made;
  made.curves.scattering = flyaways.fiber;
  const auto radius = static_cast<float>(flyaways.diameter_mm / 2);
  const Eigen::Array2d period(patch.period_x_mm, patch.period_y_mm);
  for (std::size_t y = 0; y < patch.yarns.size(); ++y) {
    const Yarn& yarn = patch.yarns[y];
    const PeriodicSpline line = center_line(patch, yarn);
    const double span_mm = yarn.warp ? patch.period_y_mm : patch.period_x_mm;
    RandomStream random(flyaways.seed, y);
    const double wanted = flyaways.per_mm * span_mm;
    const int count = static_cast<int>(wanted) + (random.uniform() < wanted - std::floor(wanted) ? 1 : 0);
    for (int i = 0; i < count; ++i) {
      const double t = random.uniform() * static_cast<double>(line.control_points.size());
      const std::vector<Vector3d> points = walk_of(line, t, yarn.radius_mm, flyaways, random);
      Eigen::AlignedBox2d box;
      for (const Vector3d& point : points) box.extend(point.head<2>());
      // Every image of it whose box meets the cell.
      const double more = flyaways.diameter_mm;
      const Eigen::Array2i first = ((-box.max().array() - more) / period).ceil().cast<int>(),
                           last = ((period - box.min().array() + more) / period).floor().cast<int>();
      for (int row = first.y(); row <= last.y(); ++row)
        for (int column = first.x(); column <= last.x(); ++column) {
          std::vector<Eigen::Vector4f> placed;
          for (const Vector3d& point : points) {
            const Vector3d at = point + Vector3d(column * period.x(), row * period.y(), 0);
            placed.emplace_back(static_cast<float>(at.x()), static_cast<float>(at.y()), static_cast<float>(at.z()),
                                radius);
          }
          made.curves.add_clamped_curve(placed);
          made.origins.resize(made.curves.segments.size(), {static_cast<int>(y), yarn.warp ? column : row});
        }
    }
  }
  return made;
}

}  // namespace renderer

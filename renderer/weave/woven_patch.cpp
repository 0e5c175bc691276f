#include "renderer/weave/woven_patch.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <random>
#include <stdexcept>
#include <string>

namespace renderer {
namespace {

using Eigen::Vector3d;

void check(const WovenOptions& options) {
  const auto refuse = [](const std::string& what) { throw std::runtime_error("weave: " + what); };
  const Unevenness& uneven = options.unevenness;
  const auto share = [](double value) { return value >= 0 && value <= kMostUnevenness; };
  if (!share(uneven.radius) || !share(uneven.pitch)) refuse("unevenness is a share from 0 to 0.2");
  if (uneven.shades < 1 || uneven.shades > kMostShades) refuse("shades of a thread are 1 to 64");
  if (!(options.transverse_modulus_n_mm2 >= 0 && options.transverse_modulus_n_mm2 < 1e9))
    refuse("the transverse modulus is 0 (sections as drafted) or positive, N/mm^2");
  if (options.plies.count < 1 || options.plies.count > kMostPlies) refuse("plies of a yarn are 1 to 12");
  if (!(std::abs(options.plies.turns_per_mm) <= kMostTurnsPerMm)) refuse("plies turn at most 20 times per mm");
  if (!(options.plies.radius_mm >= 0)) refuse("the radius of a ply is 0 (as large as fits) or positive, mm");
}

// The same numbers everywhere: the generator is specified, the standard's normal distribution is not.
double deviation(std::mt19937_64& random) {
  for (;;) {
    double sum = -6;
    for (int i = 0; i < 12; ++i) sum += static_cast<double>(random() >> 11) * 0x1p-53;
    if (std::abs(sum) <= 2) return sum;
  }
}

void make_uneven(YarnPatch& patch, const Draft& draft, const Unevenness& uneven) {
  std::mt19937_64 random(uneven.seed);
  for (Yarn& yarn : patch.yarns) {
    const double room = (yarn.warp ? draft.warp : draft.weft).pitch_mm - 2 * yarn.radius_mm;
    const double thicker = deviation(random), aside = deviation(random);
    const auto shade = static_cast<int>(random() % static_cast<std::uint64_t>(uneven.shades));
    yarn.radius_mm *= 1 + uneven.radius * thicker;
    for (Vector3d& point : yarn.control_points) point[yarn.warp ? 0 : 1] += uneven.pitch * room * aside;
    yarn.thread = yarn.thread * uneven.shades + shade;
  }
}

// How flat each yarn is under the loads of the patch at rest.
std::vector<double> flatness_under_load(const RelaxedPatch& relaxed, const Draft& draft, double modulus_n_mm2) {
  std::vector<double> flatness;
  for (std::size_t i = 0; i < relaxed.patch.yarns.size(); ++i) {
    const Yarn& yarn = relaxed.patch.yarns[i];
    const YarnSystem& system = yarn.warp ? draft.warp : draft.weft;
    const double length_mm = spline_length(center_line(relaxed.patch, yarn));
    const double load =
        relaxed.report.contact_loads_n[static_cast<Eigen::Index>(i)] / 2 / length_mm;  // from each side
    const double lower = 1 + load / (modulus_n_mm2 * 2 * yarn.radius_mm);
    const double widest = system.pitch_mm / (2 * yarn.radius_mm);
    const double most = std::max(system.flatness, std::min(kMostFlatness, widest * widest));
    flatness.push_back(std::min(system.flatness * lower * lower, most));
  }
  return flatness;
}

// Sections and loads that belong to each other: each round relaxes with sections halfway to those that its loads ask for.
RelaxedPatch flattened(YarnPatch start, const Draft& draft, const WovenOptions& options) {
  constexpr int kMostRounds = 12;
  constexpr double kGoal = 1e-3;
  RelaxedPatch relaxed = relax(start, draft, options.relaxation);
  for (int round = 0; round < kMostRounds; ++round) {
    const std::vector<double> wanted = flatness_under_load(relaxed, draft, options.transverse_modulus_n_mm2);
    double change = 0;
    for (std::size_t i = 0; i < wanted.size(); ++i) {
      double& flatness = start.yarns[i].flatness;
      change = std::max(change, std::abs(wanted[i] / flatness - 1));
      flatness = (flatness + wanted[i]) / 2;
    }
    if (change < kGoal) break;
    relaxed = relax(start, draft, options.relaxation);
  }
  return relaxed;
}

}  // namespace

double ply_radius_mm(const Plies& plies, double yarn_radius_mm) {
  if (plies.radius_mm > 0) return plies.radius_mm;
  const double sine = std::sin(M_PI / plies.count);
  return plies.count == 1 ? yarn_radius_mm : yarn_radius_mm * sine / (1 + sine);
}

YarnPatch with_plies(const YarnPatch& patch, const Plies& plies) {
  constexpr int kPointsPerTurn = 12;
  YarnPatch twisted = patch;
  twisted.yarns.clear();
  for (const Yarn& yarn : patch.yarns) {
    const PeriodicSpline line = center_line(patch, yarn);
    const int knots = static_cast<int>(line.control_points.size());
    const double turns = std::round(plies.turns_per_mm * spline_length(line));
    const int per_knot = std::max(1, static_cast<int>(std::ceil(kPointsPerTurn * std::abs(turns) / knots)));
    Yarn ply = yarn;
    ply.radius_mm = ply_radius_mm(plies, yarn.radius_mm);
    if (ply.radius_mm > yarn.radius_mm)
      throw std::runtime_error("weave: a ply of radius " + std::to_string(ply.radius_mm) +
                               " mm is thicker than its yarn of " + std::to_string(yarn.radius_mm) + " mm");
    ply.tex = yarn.tex / plies.count;
    // A flat yarn is the round one with its plies, pressed: the plies are as flat as it is, so they keep touching.
    const double room = yarn.radius_mm - ply.radius_mm, flat = std::sqrt(yarn.flatness), wide = room * flat,
                 high = room / flat;
    const Vector3d side = yarn.warp ? Vector3d::UnitX() : Vector3d::UnitY();
    for (int k = 0; k < plies.count; ++k) {
      std::vector<Vector3d> points;
      for (int i = 0; i < knots * per_knot; ++i) {
        const double t = static_cast<double>(i) / per_knot;
        const double angle = 2 * M_PI * (turns * t / knots + static_cast<double>(k) / plies.count);
        // Yarns of a cloth never run upright, so a frame with one axis in its plane turns as little as they do.
        const Vector3d along = spline_value(line, t, 1).normalized(), up = along.cross(side).normalized();
        const Vector3d across = up.cross(along);
        points.push_back(spline_value(line, t) + wide * std::cos(angle) * across + high * std::sin(angle) * up);
      }
      ply.control_points = spline_through(points, line.period).control_points;
      twisted.yarns.push_back(ply);
    }
  }
  return twisted;
}

RelaxedPatch woven_patch(const Draft& draft, const WovenOptions& options) {
  check(options);
  Draft unscaled = draft;
  unscaled.height_scale = 1;
  YarnPatch start = initial_patch(unscaled, options.relaxation.points_per_crossing);
  make_uneven(start, draft, options.unevenness);
  RelaxedPatch relaxed = options.transverse_modulus_n_mm2 > 0 ? flattened(std::move(start), draft, options)
                                                              : relax(start, draft, options.relaxation);
  check_at_rest(relaxed);
  if (options.plies.count > 1) relaxed.patch = with_plies(relaxed.patch, options.plies);
  return relaxed;
}

}  // namespace renderer

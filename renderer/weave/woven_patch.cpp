#include "renderer/weave/woven_patch.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <stdexcept>
#include <string>

#include "renderer/weave/initial_patch.h"
#include "renderer/weave/unevenness.h"

namespace renderer {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

// How flat each yarn is under the loads of the patch at rest.
std::vector<double> flatness_under_load(const RelaxedPatch& relaxed, const Draft& draft) {
  std::vector<double> flatness;
  for (std::size_t i = 0; i < relaxed.patch.yarns.size(); ++i) {
    const Yarn& yarn = relaxed.patch.yarns[i];
    const YarnSystem& system = yarn.warp ? draft.warp : draft.weft;
    const double length_mm = spline_length(center_line(relaxed.patch, yarn));
    const double load = relaxed.report.contact_loads_n[static_cast<Eigen::Index>(i)] / 2 / length_mm;  // from each side
    const double lower = 1 + load / (draft.transverse_modulus_n_mm2 * 2 * yarn.radius_mm);
    const double widest = system.pitch_mm / (2 * yarn.radius_mm);
    const double most = std::max(system.flatness, std::min(kMostFlatness, widest * widest));
    flatness.push_back(std::min(system.flatness * lower * lower, most));
  }
  return flatness;
}

// The patch at rest with sections and loads that belong to each other: each round relaxes with sections halfway to
// those that the loads of the last one ask for.
RelaxedPatch flattened(YarnPatch start, const Draft& draft, const RelaxationOptions& options) {
  constexpr int kMostRounds = 12;
  constexpr double kGoal = 1e-3;
  RelaxedPatch relaxed = relax(start, draft, options);
  for (int round = 0; round < kMostRounds; ++round) {
    const std::vector<double> wanted = flatness_under_load(relaxed, draft);
    double change = 0;
    for (std::size_t i = 0; i < wanted.size(); ++i) {
      double& flatness = start.yarns[i].flatness;
      change = std::max(change, std::abs(wanted[i] / flatness - 1));
      flatness = (flatness + wanted[i]) / 2;
    }
    if (change < kGoal) break;
    relaxed = relax(start, draft, options);
  }
  return relaxed;
}

// The control points of a strand's thickness, which is the yarn's at the strand's knots.
std::vector<double> thickness_of_strands(const Yarn& yarn, int per_knot) {
  std::vector<Vector3d> knots;
  for (std::size_t i = 0; i < yarn.thickness.size() * static_cast<std::size_t>(per_knot); ++i)
    knots.push_back({thickness(yarn, static_cast<double>(i) / per_knot), 0, 0});
  std::vector<double> control;
  if (knots.empty()) return control;
  for (const Vector3d& point : spline_through(knots, Vector3d::Zero()).control_points) control.push_back(point.x());
  return control;
}

// The share of all turns of the plies in a period that is done at each of their knots.
std::vector<double> shares_of_turns(const Yarn& yarn, int knots, int per_knot) {
  std::vector<double> shares;
  double sum = 0;
  for (int i = 0; i < knots * per_knot; ++i) {
    shares.push_back(sum);
    sum += profile_value(yarn.twist, (i + 0.5) / per_knot);
  }
  for (double& share : shares) share /= sum;
  return shares;
}

// A strand inside a yarn, with `per_knot` knots of its own for each of the yarn's; place(i) is that of its i-th knot in
// the section, mm.
Yarn strand_of(const YarnPatch& patch, const Yarn& yarn, double radius_mm, int per_knot,
               const std::function<Vector2d(int)>& place) {
  if (radius_mm > yarn.radius_mm)
    throw std::runtime_error("weave: a strand of radius " + std::to_string(radius_mm) +
                             " mm is thicker than its yarn of " + std::to_string(yarn.radius_mm) + " mm");
  const PeriodicSpline line = center_line(patch, yarn);
  const int knots = static_cast<int>(line.control_points.size()) * per_knot;
  const Vector3d side = yarn.warp ? Vector3d::UnitX() : Vector3d::UnitY();
  Yarn strand = yarn;
  strand.radius_mm = radius_mm;
  strand.thickness = thickness_of_strands(yarn, per_knot);
  strand.twist.clear();
  strand.threads.clear();
  std::vector<Vector3d> points;
  for (int i = 0; i < knots; ++i) {
    if (!yarn.threads.empty()) strand.threads.push_back(thread_of_segment(yarn, i / per_knot));
    const double t = static_cast<double>(i) / per_knot;
    // Yarns of a cloth never run upright, so that a frame with one axis in the cloth's plane turns as little as they
    // do.
    const Vector3d along = spline_value(line, t, 1).normalized(), up = along.cross(side).normalized();
    const Vector2d at = thickness(yarn, t) * place(i);
    points.push_back(spline_value(line, t) + at.x() * up.cross(along) + at.y() * up);
  }
  strand.control_points = spline_through(points, line.period).control_points;
  return strand;
}

}  // namespace

double ply_radius_mm(const Plies& plies, double yarn_radius_mm) {
  if (plies.radius_mm > 0) return plies.radius_mm;
  const double sine = std::sin(std::numbers::pi / plies.count);
  return plies.count == 1 ? yarn_radius_mm : yarn_radius_mm * sine / (1 + sine);
}

YarnPatch with_plies(const YarnPatch& patch, const Plies& plies) {
  constexpr int kPointsPerTurn = 12;
  YarnPatch twisted = patch;
  twisted.yarns.clear();
  for (const Yarn& yarn : patch.yarns) {
    const double length_mm = spline_length(center_line(patch, yarn)),
                 turns = std::round(plies.turns_per_mm * length_mm);
    const int knots = static_cast<int>(yarn.control_points.size());
    const int per_knot = std::max(1, static_cast<int>(std::ceil(kPointsPerTurn * std::abs(turns) / knots)));
    const double radius_mm = ply_radius_mm(plies, yarn.radius_mm);
    const std::vector<double> turned = shares_of_turns(yarn, knots, per_knot);
    // A flat yarn is the round one pressed with its plies: they are as flat as it is, so that they keep touching.
    const double flat = std::sqrt(yarn.flatness);
    for (int k = 0; k < plies.count; ++k) {
      Yarn ply = strand_of(patch, yarn, radius_mm, per_knot, [&](int i) {
        const double angle =
            2 * std::numbers::pi * (turns * turned[static_cast<std::size_t>(i)] + static_cast<double>(k) / plies.count);
        return Vector2d((yarn.radius_mm - radius_mm) * Vector2d(flat * std::cos(angle), std::sin(angle) / flat));
      });
      ply.tex = yarn.tex / plies.count;
      twisted.yarns.push_back(std::move(ply));
    }
  }
  return twisted;
}

YarnPatch with_strands(const YarnPatch& patch, const std::vector<Strands>& of_yarns) {
  if (of_yarns.size() != patch.yarns.size())
    throw std::invalid_argument("with_strands: " + std::to_string(of_yarns.size()) + " bundles for " +
                                std::to_string(patch.yarns.size()) + " yarns");
  YarnPatch divided = patch;
  divided.yarns.clear();
  for (std::size_t i = 0; i < of_yarns.size(); ++i)
    for (const Vector2d& place : of_yarns[i].places) {
      Yarn strand = strand_of(patch, patch.yarns[i], of_yarns[i].radius_mm, 1, [&](int) { return place; });
      strand.tex = 0;
      strand.flatness = 1;
      divided.yarns.push_back(std::move(strand));
    }
  return divided;
}

YarnPatch repeated(const YarnPatch& patch, int across, int along) {
  YarnPatch all = patch;
  all.period_x_mm *= across, all.period_y_mm *= along;
  all.yarns.clear();
  const Vector3d x(patch.period_x_mm, 0, 0), y(0, patch.period_y_mm, 0);
  for (const bool warp : {true, false})
    for (int copy = 0; copy < (warp ? across : along); ++copy)
      for (const Yarn& yarn : patch.yarns) {
        if (yarn.warp != warp) continue;
        Yarn& longer = all.yarns.emplace_back(yarn);
        longer.control_points.clear();
        for (int period = 0; period < (warp ? along : across); ++period)
          for (const Vector3d& point : yarn.control_points)
            longer.control_points.push_back(point + (warp ? copy * x + period * y : copy * y + period * x));
        for (int period = 1; period < (warp ? along : across); ++period) {
          longer.thickness.insert(longer.thickness.end(), yarn.thickness.begin(), yarn.thickness.end());
          longer.twist.insert(longer.twist.end(), yarn.twist.begin(), yarn.twist.end());
          longer.threads.insert(longer.threads.end(), yarn.threads.begin(), yarn.threads.end());
        }
      }
  return all;
}

RelaxedPatch woven_patch(const Draft& draft, const RelaxationOptions& options) {
  if (!draft.relaxed) {
    RelaxedPatch drawn{.patch = initial_patch(draft, options.points_per_crossing)};
    make_uneven(drawn.patch, draft);
    if (draft.plies.count > 1) drawn.patch = with_plies(drawn.patch, draft.plies);
    return drawn;
  }
  Draft unscaled = draft;
  unscaled.height_scale = 1;
  YarnPatch start = initial_patch(unscaled, options.points_per_crossing);
  make_uneven(start, draft);
  RelaxedPatch relaxed =
      draft.transverse_modulus_n_mm2 > 0 ? flattened(std::move(start), draft, options) : relax(start, draft, options);
  check_at_rest(relaxed);
  if (draft.plies.count > 1) relaxed.patch = with_plies(relaxed.patch, draft.plies);
  return relaxed;
}

}  // namespace renderer

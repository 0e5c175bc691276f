#include "renderer/weave/crossings.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>

namespace renderer {
namespace {

Eigen::Vector2d in_plan(const YarnPatch& patch, const Eigen::Vector3d& difference) {
  return {std::remainder(difference.x(), patch.period_x_mm), std::remainder(difference.y(), patch.period_y_mm)};
}

// The knot at which a yarn that runs along `axis` comes nearest to `value` (up to periods). The coordinate rises by one
// period per turn, and no relaxed yarn strays far from even, so that a start for Newton's method is among the knots.
double nearest_knot(const PeriodicSpline& line, int axis, double value, double period) {
  double best = 0, least = std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < line.control_points.size(); ++k) {
    const double t = static_cast<double>(k);
    const double off = std::abs(std::remainder(spline_value(line, t)[axis] - value, period));
    if (off < least) {
      least = off;
      best = t;
    }
  }
  return best;
}

Crossing crossing_of(const YarnPatch& patch, std::size_t warp, std::size_t weft) {
  const PeriodicSpline a = center_line(patch, patch.yarns[warp]), b = center_line(patch, patch.yarns[weft]);
  double s = nearest_knot(a, 1, b.control_points.front().y(), patch.period_y_mm);
  double t = nearest_knot(b, 0, a.control_points.front().x(), patch.period_x_mm);
  for (int step = 0; step < 30; ++step) {
    const Eigen::Vector2d off = in_plan(patch, spline_value(b, t) - spline_value(a, s));
    Eigen::Matrix2d jacobian;
    jacobian << -spline_value(a, s, 1).head<2>(), spline_value(b, t, 1).head<2>();
    const Eigen::Vector2d move = -(jacobian.inverse() * off).cwiseMax(-1.0).cwiseMin(1.0);
    s += move[0];
    t += move[1];
    if (move.cwiseAbs().maxCoeff() < 1e-12) break;
  }
  const double warp_z = spline_value(a, s).z(), weft_z = spline_value(b, t).z();
  const Eigen::Vector3d across_both = spline_value(a, s, 1).cross(spline_value(b, t, 1)).normalized();
  return {.warp = warp,
          .weft = weft,
          .warp_z_mm = warp_z,
          .weft_z_mm = weft_z,
          .distance_mm = std::abs((warp_z - weft_z) * across_both.z()),
          .warp_t = s,
          .weft_t = t};
}

}  // namespace

std::vector<Crossing> crossings_of(const YarnPatch& patch) {
  std::vector<Crossing> crossings;
  for (std::size_t i = 0; i < patch.yarns.size(); ++i)
    for (std::size_t j = 0; j < patch.yarns.size(); ++j)
      if (patch.yarns[i].warp && !patch.yarns[j].warp) crossings.push_back(crossing_of(patch, i, j));
  return crossings;
}

bool is_as_drafted(const YarnPatch& patch, const Draft& draft) {
  const auto& rows = draft.warp_over;
  const auto ends = static_cast<std::size_t>(ends_in_patch(draft));
  const std::vector<Crossing> crossings = crossings_of(patch);
  return std::all_of(crossings.begin(), crossings.end(), [&](const Crossing& crossing) {
    const std::size_t end = crossing.warp, pick = crossing.weft - ends;
    return (crossing.warp_z_mm > crossing.weft_z_mm) == rows[pick % rows.size()][end % rows[0].size()];
  });
}

}  // namespace renderer

#include "renderer/weave/patch_measures.h"

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace renderer {
namespace {

constexpr int kSamplesPerSegment = 4;

struct Sample {
  Eigen::Vector3d point = Eigen::Vector3d::Zero();
  std::size_t yarn = 0;
  double t = 0;
};

struct Pair {
  Sample a, b;
  double gap_mm = std::numeric_limits<double>::infinity();
};

double mean_crimp(const YarnPatch& patch, bool warp) {
  double sum = 0;
  int count = 0;
  for (const Yarn& yarn : patch.yarns) {
    if (yarn.warp != warp) continue;
    sum += crimp(patch, yarn);
    ++count;
  }
  return count ? sum / count : 0;
}

Eigen::Vector3d nearest_image(const YarnPatch& patch, Eigen::Vector3d difference) {
  difference.x() -= patch.period_x_mm * std::round(difference.x() / patch.period_x_mm);
  difference.y() -= patch.period_y_mm * std::round(difference.y() / patch.period_y_mm);
  return difference;
}

// The samples of all yarns, sorted into the squares of a periodic grid over the cell.
class SampleGrid {
 public:
  explicit SampleGrid(const YarnPatch& patch) : patch_(patch) {
    double size = 0;
    std::array<double, 2> yarns{0, 0};
    for (const Yarn& yarn : patch.yarns) {
      size = std::max(size, 2 * yarn.radius_mm * profile_bound(yarn.thickness));
      ++yarns[yarn.warp ? 0 : 1];
    }
    // A square is one diameter or one pitch wide, so that neighbouring squares hold the neighbouring yarns.
    columns_ = squares_along(patch.period_x_mm, std::max(size, patch.period_x_mm / std::max(1.0, yarns[0])));
    rows_ = squares_along(patch.period_y_mm, std::max(size, patch.period_y_mm / std::max(1.0, yarns[1])));
    squares_.resize(static_cast<std::size_t>(columns_ * rows_));
    for (std::size_t i = 0; i < patch.yarns.size(); ++i) add(i);
  }

  template <typename Visit>
  void for_each_near_pair(Visit&& visit) const {
    for (int row = 0; row < rows_; ++row) {
      for (int column = 0; column < columns_; ++column) {
        for (int dy = rows_ < 3 ? 0 : -1; dy <= (rows_ < 2 ? 0 : 1); ++dy) {
          for (int dx = columns_ < 3 ? 0 : -1; dx <= (columns_ < 2 ? 0 : 1); ++dx) {
            const auto& others = square(row + dy, column + dx);
            for (const Sample& a : square(row, column)) {
              for (const Sample& b : others)
                if (a.yarn < b.yarn) visit(a, b);
            }
          }
        }
      }
    }
  }

 private:
  static int squares_along(double period, double size) { return std::max(1, static_cast<int>(period / size)); }

  void add(std::size_t index) {
    const PeriodicSpline line = center_line(patch_, patch_.yarns[index]);
    for (std::size_t k = 0; k < line.control_points.size() * kSamplesPerSegment; ++k) {
      const double t = static_cast<double>(k) / kSamplesPerSegment;
      const Eigen::Vector3d point = spline_value(line, t);
      const auto row = static_cast<int>(std::floor(point.y() / patch_.period_y_mm * rows_));
      const auto column = static_cast<int>(std::floor(point.x() / patch_.period_x_mm * columns_));
      square(row, column).push_back({point, index, t});
    }
  }

  std::size_t place(int row, int column) const {
    const int r = (row % rows_ + rows_) % rows_, c = (column % columns_ + columns_) % columns_;
    return static_cast<std::size_t>(r * columns_ + c);
  }
  std::vector<Sample>& square(int row, int column) { return squares_[place(row, column)]; }
  const std::vector<Sample>& square(int row, int column) const { return squares_[place(row, column)]; }

  const YarnPatch& patch_;
  int columns_ = 1, rows_ = 1;
  std::vector<std::vector<Sample>> squares_;
};

double reach(const YarnPatch& patch, std::size_t a, double s, std::size_t b, double t) {
  const Yarn &first = patch.yarns[a], &second = patch.yarns[b];
  return first.radius_mm * thickness(first, s) + second.radius_mm * thickness(second, t);
}

// The gap at the closest points of two centre lines near a pair of samples, by a few Gauss-Newton steps of at most one
// sample each.
double refined_gap(const YarnPatch& patch, const Pair& pair) {
  const PeriodicSpline a = center_line(patch, patch.yarns[pair.a.yarn]),
                       b = center_line(patch, patch.yarns[pair.b.yarn]);
  const Eigen::Vector3d difference = pair.b.point - pair.a.point;
  const Eigen::Vector3d shift = nearest_image(patch, difference) - difference;
  double s = pair.a.t, t = pair.b.t, best = pair.gap_mm;
  for (int step = 0; step < 20; ++step) {
    const Eigen::Vector3d gap = spline_value(b, t) + shift - spline_value(a, s);
    best = std::min(best, gap.norm() - reach(patch, pair.a.yarn, s, pair.b.yarn, t));
    Eigen::Matrix<double, 3, 2> jacobian;
    jacobian << -spline_value(a, s, 1), spline_value(b, t, 1);
    Eigen::Matrix2d normal = jacobian.transpose() * jacobian;
    normal.diagonal() *= 1 + 1e-6;  // parallel yarns leave sliding free
    const Eigen::Vector2d move = -(normal.inverse() * (jacobian.transpose() * gap)).cwiseMax(-0.25).cwiseMin(0.25);
    s += move[0];
    t += move[1];
  }
  return best;
}

}  // namespace

double crimp(const YarnPatch& patch, const Yarn& yarn) {
  return spline_length(center_line(patch, yarn)) / period_of(patch, yarn).norm() - 1;
}

SurfaceRange surface_range(const YarnPatch& patch) {
  constexpr int kSteps = 16;
  SurfaceRange range{.low_mm = std::numeric_limits<double>::infinity(),
                     .high_mm = -std::numeric_limits<double>::infinity()};
  for (const Yarn& yarn : patch.yarns) {
    const PeriodicSpline line = center_line(patch, yarn);
    for (std::size_t k = 0; k < line.control_points.size() * kSteps; ++k) {
      const double t = static_cast<double>(k) / kSteps, z = spline_value(line, t).z(),
                   high = half_height(yarn) * thickness(yarn, t);
      range.low_mm = std::min(range.low_mm, z - high);
      range.high_mm = std::max(range.high_mm, z + high);
    }
  }
  return range;
}

double cover(const YarnPatch& patch) {
  double warp = 0, weft = 0;
  for (const Yarn& yarn : patch.yarns)
    if (yarn.warp)
      warp += 2 * half_width(yarn) / patch.period_x_mm;
    else
      weft += 2 * half_width(yarn) / patch.period_y_mm;
  return 1 - (1 - std::min(warp, 1.0)) * (1 - std::min(weft, 1.0));
}

double areal_mass(const YarnPatch& patch) {
  double mass_g = 0;
  for (const Yarn& yarn : patch.yarns) {
    if (yarn.tex == 0) return 0;
    mass_g += yarn.tex * 1e-6 * spline_length(center_line(patch, yarn));  // tex = 1e-6 g per mm
  }
  return mass_g / (patch.period_x_mm * patch.period_y_mm * 1e-6);
}

double least_gap(const YarnPatch& patch) {
  Pair closest;
  SampleGrid(patch).for_each_near_pair([&](const Sample& a, const Sample& b) {
    const double gap = nearest_image(patch, b.point - a.point).norm() - reach(patch, a.yarn, a.t, b.yarn, b.t);
    if (gap < closest.gap_mm) closest = {a, b, gap};
  });
  if (!std::isfinite(closest.gap_mm)) return closest.gap_mm;  // fewer than two yarns
  return refined_gap(patch, closest);
}

void measure(YarnPatch& patch) {
  const SurfaceRange range = surface_range(patch);
  patch.thickness_mm = range.high_mm - range.low_mm;
  patch.crimp_warp = mean_crimp(patch, true);
  patch.crimp_weft = mean_crimp(patch, false);
  patch.areal_mass_g_m2 = areal_mass(patch);
  patch.cover = cover(patch);
  patch.least_gap_mm = least_gap(patch);
}

}  // namespace renderer

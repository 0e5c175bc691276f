#include "renderer/embroidery/stitch_curves.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

namespace renderer {
namespace {

using Eigen::Vector2d;

constexpr double kPerStep = 0.5;        // of the diameter, between points along a stitch
constexpr double kReach = 0.35;         // of the diameter, to either side: what a crossing thread lies on
constexpr double kMostCells = 1 << 24;  // of the relief

// The height of what has been sewn, over the cells of a grid.
class Relief {
 public:
  Relief(const MotifMeasures& extents, double diameter_mm)
      : low_(extents.low.array() - diameter_mm), cell_mm_(diameter_mm / 6) {
    const Vector2d size = extents.high - extents.low + Vector2d::Constant(2 * diameter_mm);
    cell_mm_ = std::max(cell_mm_, std::sqrt(size.prod() / kMostCells));
    columns_ = static_cast<int>(size.x() / cell_mm_) + 1;
    rows_ = static_cast<int>(size.y() / cell_mm_) + 1;
    tops_.assign(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_), 0.0F);
  }

  double top(const Vector2d& at) const {
    const Eigen::Vector2i cell = cell_of(at);
    return tops_[index(cell.x(), cell.y())];
  }

  void raise(const Vector2d& at, double reach_mm, double top_mm) {
    const Eigen::Vector2i from = cell_of(at.array() - reach_mm), to = cell_of(at.array() + reach_mm);
    for (int row = from.y(); row <= to.y(); ++row)
      for (int column = from.x(); column <= to.x(); ++column) {
        const Vector2d center = low_ + cell_mm_ * Vector2d(column + 0.5, row + 0.5);
        float& top = tops_[index(column, row)];
        if ((center - at).norm() <= reach_mm) top = std::max(top, static_cast<float>(top_mm));
      }
  }

  double cell_mm() const { return cell_mm_; }

 private:
  Eigen::Vector2i cell_of(const Vector2d& at) const {
    const Vector2d place = (at - low_) / cell_mm_;
    return {std::clamp(static_cast<int>(place.x()), 0, columns_ - 1),
            std::clamp(static_cast<int>(place.y()), 0, rows_ - 1)};
  }
  std::size_t index(int column, int row) const {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(columns_) + static_cast<std::size_t>(column);
  }

  Vector2d low_;
  double cell_mm_;
  int columns_ = 0, rows_ = 0;
  std::vector<float> tops_;
};

// A string pulled taut over what it must stay above: the upper hull of the points (place along it, least height).
std::vector<double> taut(const std::vector<Vector2d>& points) {
  std::vector<std::size_t> hull;
  for (std::size_t i = 0; i < points.size(); ++i) {
    while (hull.size() >= 2) {
      const Vector2d a = points[hull[hull.size() - 2]], b = points[hull.back()], c = points[i];
      if ((b.y() - a.y()) * (c.x() - a.x()) > (c.y() - a.y()) * (b.x() - a.x())) break;
      hull.pop_back();
    }
    hull.push_back(i);
  }
  std::vector<double> heights;
  for (std::size_t k = 0, i = 0; i < points.size(); ++i) {
    while (k + 2 < hull.size() && points[hull[k + 1]].x() < points[i].x()) ++k;
    const Vector2d a = points[hull[k]], b = points[hull[k + 1]];
    const double share = (points[i].x() - a.x()) / (b.x() - a.x());
    heights.push_back(a.y() + share * (b.y() - a.y()));
  }
  return heights;
}

}  // namespace

StitchCurves stitch_curves(const Motif& motif, double diameter_mm) {
  if (!(diameter_mm > 0))
    throw std::runtime_error("embroidery: the thread's diameter is " + std::to_string(diameter_mm) +
                             " mm; give one above 0");
  const MotifMeasures measures = measure(motif);
  if (measures.stitches == 0)
    throw std::runtime_error("embroidery: \"" + motif.name + "\" has no stitches; give a file with at least one");
  if (measures.stitches > kMostStitches)
    throw std::runtime_error("embroidery: \"" + motif.name + "\" has " + std::to_string(measures.stitches) +
                             " stitches, at most " + std::to_string(kMostStitches) + " are drawn; give a part of it");
  Relief relief(measures, diameter_mm);
  StitchCurves result;
  result.threads.resize(motif.threads.size());
  const double radius = diameter_mm / 2;
  for (const StitchRun& run : motif.runs)
    for (std::size_t i = 1; i < run.needle_points.size(); ++i) {
      const Vector2d from = run.needle_points[i - 1], to = run.needle_points[i];
      const double length = (to - from).norm();
      if (length < diameter_mm / 10) continue;
      const int steps = std::max(4, static_cast<int>(std::ceil(length / (kPerStep * diameter_mm))));
      std::vector<Vector2d> least;  // along the stitch, and how high its axis must be
      for (int k = 0; k <= steps; ++k) {
        const double share = static_cast<double>(k) / steps;
        const bool end = k == 0 || k == steps;
        least.push_back({share * length, end ? -radius : relief.top(from + share * (to - from)) + radius});
      }
      const std::vector<double> heights = taut(least);
      std::vector<Eigen::Vector4f> points;
      for (int k = 0; k <= steps; ++k) {
        const Vector2d at = from + static_cast<double>(k) / steps * (to - from);
        const double z = heights[static_cast<std::size_t>(k)];
        points.push_back(Eigen::Vector4d(at.x(), at.y(), z, radius).cast<float>());
        result.top_mm = std::max(result.top_mm, z + radius);
      }
      result.threads[static_cast<std::size_t>(run.thread)].add_clamped_curve(points);
      // Between the points the thread is as high as the higher of the two.
      const int marks = std::max(1, static_cast<int>(std::ceil(length / relief.cell_mm())));
      for (int m = 1; m < marks; ++m) {
        const double place = static_cast<double>(m) / marks * steps;
        const auto k = static_cast<std::size_t>(place);
        const double z = std::max(heights[k], heights[k + 1]);
        if (z < radius / 2) continue;  // where the thread dips into the cloth nothing lies on it
        relief.raise(from + place / steps * (to - from), kReach * diameter_mm, z + (kLayerHeight - 0.5) * diameter_mm);
      }
    }
  return result;
}

}  // namespace renderer

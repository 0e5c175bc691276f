// A grid of square cells over equal circles that do not overlap, so that a ray is tested only against the circles near
// its way.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

namespace renderer {

struct CircleHit {
  int circle = -1;      // -1: none
  double distance = 0;  // along the ray to where it enters the circle, or leaves the square if it meets none
};

class CircleGrid {
 public:
  CircleGrid() : CircleGrid({}, 1, 1) {}
  // The grid of circles of `radius` around `centers`, all of which lie inside the square of half side `reach` around
  // the origin.
  CircleGrid(const std::vector<Eigen::Vector2d>& centers, double radius, double reach);

  // The nearest circle that the ray from `origin` (inside the square, outside all circles) in unit `direction` enters;
  // circle number `leaving` (-1 for none), on whose border the ray starts, is passed over.
  CircleHit nearest(const Eigen::Vector2d& origin, const Eigen::Vector2d& direction, int leaving) const {
    // The walk from cell to cell (Amanatides and Woo 1987) has no branches but those that end it.
    Walk x(origin.x(), direction.x(), reach_, cell_, inverse_cell_, side_);
    Walk y(origin.y(), direction.y(), reach_, cell_, inverse_cell_, side_);
    CircleHit best{-1, std::min(x.exit, y.exit)};
    const int step_x = x.step, step_y = y.step * (side_ + 2);
    int cell = (y.cell + 1) * (side_ + 2) + x.cell + 1;
    for (;;) {
      const auto c = static_cast<std::size_t>(cell);
      for (std::uint32_t k = first_[c]; k < first_[c + 1]; ++k) {
        const Entry& entry = entries_[k];
        const Eigen::Vector2d to = entry.center - origin;
        const double along = to.dot(direction), across = to.x() * direction.y() - to.y() * direction.x();
        const double half_chord2 = radius2_ - across * across;
        // One branch for three conditions that are all hard to foresee.
        if (!((along > 0) & (half_chord2 > 0) & (entry.circle != leaving))) continue;
        const double distance = along - std::sqrt(half_chord2);
        if (distance < best.distance) best = {entry.circle, distance};
      }
      const bool sideways = x.border < y.border;
      if (best.distance <= std::min(x.border, y.border)) return best;
      cell += sideways ? step_x : step_y;
      x.border += sideways ? x.per_cell : 0;
      y.border += sideways ? 0 : y.per_cell;
    }
  }

  const Eigen::Vector2d& center(int circle) const { return centers_[static_cast<std::size_t>(circle)]; }
  std::size_t size() const { return centers_.size(); }

 private:
  struct Entry {
    Eigen::Vector2d center;
    int circle;
  };

  // A ray's way through the cells along one axis; distances are measured along the ray.
  struct Walk {
    int cell, step;
    double border, per_cell;  // distance to where the cell ends; distance from one border to the next
    double exit;              // distance to where the square ends

    Walk(double origin, double direction, double reach, double size, double inverse_size, int side) {
      const double position = origin + reach;
      cell = std::clamp(static_cast<int>(position * inverse_size), 0, side - 1);
      const bool up = direction > 0;
      step = up ? 1 : -1;
      // A ray almost parallel to the borders counts as parallel: they then are too far away to be met.
      const double inverse = 1 / (std::abs(direction) > 1e-30 ? direction : -1e-30);
      per_cell = size * std::abs(inverse);
      border = ((up ? cell + 1 : cell) * size - position) * inverse;
      exit = ((up ? reach : -reach) - origin) * inverse;
    }
  };

  std::vector<Eigen::Vector2d> centers_;
  double radius2_, reach_, cell_, inverse_cell_;
  int side_;                          // cells across the square; a ring of empty cells lies around it
  std::vector<std::uint32_t> first_;  // index of each cell's first entry, and the number of entries at the end
  std::vector<Entry> entries_;
};

}  // namespace renderer

#include "renderer/scene/hanging_sheet.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "renderer/weave/periodic_spline.h"

namespace renderer {

using Eigen::Vector3d;

HangingSheet::HangingSheet(const Size& size, const Bending& bending, const Pattern& pattern,
                           std::vector<Vector3d> places)
    : size_(size), places_(std::move(places)) {
  add_links(pattern, bending);
}

void HangingSheet::pin_row(int row) {
  for (int column = 0; column < size_.columns; ++column) pinned_.push_back(index(column, row));
}

void HangingSheet::hang_from_row(int row, const Pattern& pattern) {
  pin_row(row);
  for (int other = 0; other < size_.rows; ++other)
    for (int column = 0; column < size_.columns && other != row; ++column)
      leashes_.push_back(
          {index(column, other), index(column, row), (pattern(column, other) - pattern(column, row)).norm()});
}

std::vector<Vector3d> HangingSheet::refined(int finer) const {
  const int columns = size_.closed ? size_.columns * finer : (size_.columns - 1) * finer + 1,
            rows = (size_.rows - 1) * finer + 1;
  std::vector<Vector3d> fine;
  for (int row = 0; row < rows; ++row)
    for (int column = 0; column < columns; ++column) {
      const Eigen::Vector4d u = spline_weights(static_cast<double>(column % finer) / finer),
                            v = spline_weights(static_cast<double>(row % finer) / finer);
      Vector3d at = Vector3d::Zero();
      for (int j = 0; j < 4; ++j)
        for (int i = 0; i < 4; ++i) at += u[i] * v[j] * control(column / finer + i - 1, row / finer + j - 1);
      fine.push_back(at);
    }
  return fine;
}

void HangingSheet::smooth(int times) {
  for (int time = 0; time < times; ++time) {
    std::vector<Vector3d> smoother;
    for (int row = 0; row < size_.rows; ++row)
      for (int column = 0; column < size_.columns; ++column) {
        const Vector3d beside =
            control(column - 1, row) + control(column + 1, row) + control(column, row - 1) + control(column, row + 1);
        smoother.emplace_back(0.5 * control(column, row) + beside / 8);
      }
    places_ = std::move(smoother);
  }
}

// A place, or beyond an open border its mirror image.
Vector3d HangingSheet::control(int column, int row) const {
  if (size_.closed) column = (column + size_.columns) % size_.columns;
  const auto beyond = [](int i, int count) { return i < 0 ? 1 : (i >= count ? count - 2 : -1); };
  if (const int inner = beyond(row, size_.rows); inner >= 0)
    return 2 * control(column, std::clamp(row, 0, size_.rows - 1)) - control(column, inner);
  if (const int inner = beyond(column, size_.columns); inner >= 0)
    return 2 * control(std::clamp(column, 0, size_.columns - 1), row) - control(inner, row);
  return places_[index(column, row)];
}

void HangingSheet::add_links(const Pattern& pattern, const Bending& bending) {
  constexpr double kThread = 0, kShear = 2e-6;  // compliance of a unit mass, s^2
  struct Kind {
    int right, up;
    double compliance_s2;
  };
  // Links that follow one another share no point, so that a processor works on several at once.
  for (const Kind& kind : {Kind{1, 0, kThread},
                           {0, 1, kThread},
                           {1, 1, kShear},
                           {-1, 1, kShear},
                           {2, 0, bending.near_s2},
                           {0, 2, bending.near_s2},
                           {5, 0, bending.far_s2},
                           {0, 5, bending.far_s2}})
    for (const int half : {0, 1})
      for (int row = 0; row + kind.up < size_.rows; ++row)
        for (int column = 0; column < size_.columns; ++column) {
          int to = column + kind.right;
          if (size_.closed) to = (to + size_.columns) % size_.columns;
          if (to < 0 || to >= size_.columns) continue;
          if ((kind.up > 0 ? row / kind.up : column / kind.right) % 2 != half) continue;
          const double length_mm = (pattern(column + kind.right, row + kind.up) - pattern(column, row)).norm();
          links_.push_back({index(column, row), index(to, row + kind.up), length_mm,
                            1 / (2 + kind.compliance_s2 / (kStep_s * kStep_s))});
        }
}

void HangingSheet::part_folds() {
  constexpr double kLeast_mm = 0.3;  // of a step to the next column
  for (std::uint32_t row = 0, i = 0; row < static_cast<std::uint32_t>(size_.rows); ++row, ++i)
    for (int column = 0; column + 1 < size_.columns; ++column, ++i) {
      const double short_mm = kLeast_mm - (places_[i + 1] - places_[i]).dot(*order_);
      if (short_mm <= 0) continue;
      places_[i] -= short_mm / 2 * *order_;
      places_[i + 1] += short_mm / 2 * *order_;
    }
}

void HangingSheet::meet_itself(const Pattern& pattern) {
  constexpr double kOfCell = 0.36;
  pattern_ = pattern;
  apart_mm_.clear();
  for (int row = 0; row < size_.rows; ++row) {
    const int other = row + 1 < size_.rows ? row + 1 : row - 1;
    const double across_mm = (pattern(1, row) - pattern(0, row)).norm(),
                 along_mm = (pattern(0, other) - pattern(0, row)).norm();
    apart_mm_.resize(apart_mm_.size() + static_cast<std::size_t>(size_.columns),
                     kOfCell * std::max(across_mm, along_mm));
  }
}

bool HangingSheet::are_neighbours(std::uint32_t a, std::uint32_t b, double within_mm) const {
  const int columns = size_.columns, a_row = static_cast<int>(a) / columns, b_row = static_cast<int>(b) / columns;
  int right = static_cast<int>(b) % columns - static_cast<int>(a) % columns;
  if (size_.closed) right = (right + columns + columns / 2) % columns - columns / 2;
  if (std::abs(right) <= 1 && std::abs(b_row - a_row) <= 1) return true;
  return (pattern_(right, b_row) - pattern_(0, a_row)).norm() < within_mm;
}

void HangingSheet::find_near_points() {
  constexpr double kFurther = 1.5;  // than they may be, so that they are found before they meet
  constexpr double kNeighbours = 2;
  const double cell_mm = 2 * kFurther * *std::ranges::max_element(apart_mm_);
  const auto count = static_cast<std::uint32_t>(places_.size());
  const auto cell_of = [&](const Vector3d& at) { return Eigen::Vector3i((at / cell_mm).array().floor().cast<int>()); };
  const auto slot_of = [&](const Eigen::Vector3i& cell) {
    const auto hash = static_cast<std::uint32_t>(cell.x()) * 73856093U ^
                      static_cast<std::uint32_t>(cell.y()) * 19349663U ^
                      static_cast<std::uint32_t>(cell.z()) * 83492791U;
    return hash % count;
  };
  std::vector<Eigen::Vector3i> cells;
  for (const Vector3d& at : places_) cells.push_back(cell_of(at));
  // The points of each slot, one slot after the other.
  std::vector<std::uint32_t> begins(count + 1, 0), points(count);
  for (const Eigen::Vector3i& cell : cells) ++begins[slot_of(cell) + 1];
  for (std::uint32_t slot = 0; slot < count; ++slot) begins[slot + 1] += begins[slot];
  std::vector<std::uint32_t> next(begins.begin(), begins.end() - 1);
  for (std::uint32_t i = 0; i < count; ++i) points[next[slot_of(cells[i])]++] = i;

  near_.clear();
  for (std::uint32_t a = 0; a < count; ++a) {
    for (int around = 0; around < 27; ++around) {
      const Eigen::Vector3i other = cells[a] + Eigen::Vector3i(around % 3 - 1, around / 3 % 3 - 1, around / 9 - 1);
      const std::uint32_t slot = slot_of(other);
      for (std::uint32_t k = begins[slot]; k < begins[slot + 1]; ++k) {
        const std::uint32_t b = points[k];
        const double least_mm = apart_mm_[a] + apart_mm_[b];
        if (b <= a || (places_[a] - places_[b]).squaredNorm() > kFurther * kFurther * least_mm * least_mm) continue;
        if (cells[b] == other && !are_neighbours(a, b, kNeighbours * least_mm)) near_.push_back({a, b, least_mm});
      }
    }
  }
}

void HangingSheet::part_near_points() {
  for (const NearPoints& pair : near_) {
    const Vector3d between = places_[pair.b] - places_[pair.a];
    const double distance = between.norm();
    if (distance >= pair.least_mm || distance < 1e-9) continue;
    const Vector3d half = (pair.least_mm - distance) / (2 * distance) * between;
    places_[pair.a] -= half;
    places_[pair.b] += half;
  }
}

void HangingSheet::pull_links() {
  for (const Link& link : links_) {
    const Vector3d between = places_[link.b] - places_[link.a];
    const double length = std::max(between.norm(), 1e-9);
    const double share = (1 - link.length_mm / length) * link.yielding;
    places_[link.a] += share * between;
    places_[link.b] -= share * between;
  }
  for (const Leash& leash : leashes_) {
    const Vector3d between = places_[leash.point] - places_[leash.pin];
    const double length = between.norm();
    if (length > leash.most_mm) places_[leash.point] = places_[leash.pin] + leash.most_mm / length * between;
  }
}

}  // namespace renderer

#include "renderer/scene/hanging_sheet.h"

#include <algorithm>
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

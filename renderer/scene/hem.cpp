#include "renderer/scene/hem.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

namespace renderer {

using Eigen::Vector3d;

namespace {

constexpr int kFoldSteps = 8;

class Rows {
 public:
  explicit Rows(const HungRows& cloth) : cloth_(cloth) {}

  const Vector3d& at(int column, int row) const {
    return cloth_.places[static_cast<std::size_t>(row * cloth_.columns + column)];
  }
  // The direction down the cloth.
  Vector3d down(int column, int row) const {
    const int lower = std::min(row + 1, cloth_.rows - 1);
    return (at(column, lower) - at(column, std::max(row - 1, 0))).normalized();
  }
  // The direction out of the face.
  Vector3d outwards(int column, int row) const {
    const int last = cloth_.columns - 1;
    const int left = column > 0 ? column - 1 : (cloth_.closed ? last : 0),
              right = column < last ? column + 1 : (cloth_.closed ? 0 : last);
    return down(column, row).cross(at(right, row) - at(left, row)).normalized();
  }

 private:
  const HungRows& cloth_;
};

}  // namespace

Hem hem_of(const HungRows& cloth, double hem_mm) {
  Hem hem;
  if (hem_mm <= 0) return hem;
  const Rows rows(cloth);
  const int last = cloth.rows - 1;
  const auto add_row = [&](const auto& place) {
    double sum = 0;
    for (int column = 0; column < cloth.columns; ++column) {
      const Vector3d& before = hem.below_mm.empty()
                                   ? rows.at(column, last)
                                   : hem.places[hem.places.size() - static_cast<std::size_t>(cloth.columns)];
      const Vector3d at = place(column);
      sum += (at - before).norm() / cloth.columns;
      hem.places.push_back(at);
    }
    hem.below_mm.push_back((hem.below_mm.empty() ? 0 : hem.below_mm.back()) + sum);
  };
  for (int step = 1; step <= kFoldSteps; ++step) {
    const double angle = std::numbers::pi * step / kFoldSteps;
    add_row([&](int column) -> Vector3d {
      return rows.at(column, last) + kHemFold_mm * (std::sin(angle) * rows.down(column, last) -
                                                    (1 - std::cos(angle)) * rows.outwards(column, last));
    });
  }
  const double folded_mm = hem.below_mm.back();
  for (int row = last - 1; row > 0 && hem.below_mm.back() < folded_mm + hem_mm; --row)
    add_row(
        [&](int column) -> Vector3d { return rows.at(column, row) - 2 * kHemFold_mm * rows.outwards(column, row); });
  return hem;
}

}  // namespace renderer

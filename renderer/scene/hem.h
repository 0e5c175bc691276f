// The turned-up edge of a hanging cloth.
#pragma once

#include <Eigen/Core>
#include <vector>

namespace renderer {

// Points of a cloth in rows from the upper edge down; a closed sheet's last column is followed by its first. Seen from
// the face, columns go right.
struct HungRows {
  std::vector<Eigen::Vector3d> places{};  // columns x rows of them, row after row, mm
  int columns = 0, rows = 0;
  bool closed = false;
};

// Rows that go on from the last one: the cloth turned up behind itself, about as far as asked, following the cloth in
// front of it.
struct Hem {
  std::vector<Eigen::Vector3d> places{};  // of the same columns, row after row
  std::vector<double> below_mm{};         // of each row: how far the cloth goes on from the last row to there, mean
};

// Its fold is a half circle of this radius, so that there is room for cloth of less than this thickness.
inline constexpr double kHemFold_mm = 1.2;

// Nothing where `hem_mm` is 0. It ends below the upper edge.
Hem hem_of(const HungRows& cloth, double hem_mm);

}  // namespace renderer

// The triangles of a grid of vertices.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

namespace renderer {

// The triangles of (columns + 1) x (rows + 1) vertices numbered row after row; they turn counter-clockwise where
// columns go right and rows up.
inline std::vector<std::array<std::uint32_t, 3>> grid_triangles(int columns, int rows) {
  std::vector<std::array<std::uint32_t, 3>> triangles;
  const auto index = [&](int column, int row) { return static_cast<std::uint32_t>(row * (columns + 1) + column); };
  for (int row = 0; row < rows; ++row)
    for (int column = 0; column < columns; ++column) {
      const std::uint32_t a = index(column, row), b = index(column + 1, row), c = index(column + 1, row + 1),
                          d = index(column, row + 1);
      triangles.push_back({a, b, c});
      triangles.push_back({a, c, d});
    }
  return triangles;
}

}  // namespace renderer

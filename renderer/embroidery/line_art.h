// Line art: coloured lines, as a drawing has them before it is digitised (digitise.h).
//
// Frame: x right, y up, millimetres.
#pragma once

#include <Eigen/Core>
#include <array>
#include <string>
#include <vector>

namespace renderer {

inline constexpr double kLineStep_mm = 0.1;  // between neighbouring points of a line at most, give or take a little

struct ArtLine {
  std::array<unsigned char, 3> srgb{};
  double width_mm = 0;                  // of the stroke; 0 for the outline of a filled shape
  std::vector<Eigen::Vector2d> points;  // at least two; neighbours differ
};

struct LineArt {
  std::string name;
  std::vector<ArtLine> lines;  // in the order of drawing: later ones lie on top
};

}  // namespace renderer

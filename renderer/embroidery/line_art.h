// Line art: coloured lines and filled shapes, as a drawing has them before it is digitised (digitise.h).
//
// Frame: x right, y up, millimetres.
#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <string>
#include <vector>

namespace renderer {

inline constexpr double kLineStep_mm = 0.1;  // between neighbouring points of a line at most, give or take a little

struct ArtLine {
  std::array<unsigned char, 3> srgb{};
  double width_mm = 0;                  // of the stroke
  std::vector<Eigen::Vector2d> points;  // at least two; neighbours differ
  // A filled shape instead of a line: its outlines, each closed by a line from its last point to its first.
  std::vector<std::vector<Eigen::Vector2d>> area{};
  bool even_odd = false;              // which of its places are inside: else those with a winding number
  std::optional<double> along_rad{};  // in which its stitches run, from x; nothing: nobody has drawn it
};

struct LineArt {
  std::string name;
  std::vector<ArtLine> lines;  // in the order of drawing: later ones lie on top
};

}  // namespace renderer

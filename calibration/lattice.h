// Printed corners on one regular lattice, and where pictures show them: what the lens calibration works on.
//
// Node (column, row) lies at (column, row) * spacing: rows count upwards, so that with +x right and +y up the lattice's
// +z points towards the viewer. A chessboard's inner corners fill their lattice; on a tag board whose gap is a simple
// fraction of the tag, the tags' corners lie on some of its nodes.
#pragma once

#include <Eigen/Geometry>
#include <optional>
#include <string>
#include <vector>

#include "calibration/tags.h"

namespace calibration {

struct Lattice {
  int columns = 0, rows = 0;
  double spacing_mm = 0.0;

  Eigen::Vector3d point(int column, int row) const { return {column * spacing_mm, row * spacing_mm, 0.0}; }
};

struct LatticeCorner {
  int column = 0, row = 0;
  Eigen::Vector2d pixel = Eigen::Vector2d::Zero();
};

using LatticeView = std::vector<LatticeCorner>;  // of one picture

// The lattice that a tag board's corners lie on, and the way from its frame to the board's.
struct TagLattice {
  Lattice lattice;
  Eigen::Isometry3d lattice_from_board = Eigen::Isometry3d::Identity();
};

// Throws std::runtime_error when the tags do not lie upright in one plane or no spacing down to a twentieth of a tag
// fits all of them.
TagLattice lattice_of(const TagLayout& board);

// Tags that the board does not have are left out. Throws std::runtime_error on corners that are not finite numbers.
LatticeView on_lattice(const TagLattice& tags, const TagLayout& board, const TagObservation& seen);

// How a picture contradicts a board: on which side it was seen, and which corners lie elsewhere than on the print.
struct BoardCheck {
  bool mirrored = false;        // right and left are exchanged
  std::vector<bool> displaced;  // one per corner: off by more than a lattice spacing
};

// By the plane-to-plane mapping that most corners agree on; std::nullopt for fewer than 8 corners or when no such
// mapping has half of them. Lens distortion of up to a tenth of a spacing across the board does not matter.
std::optional<BoardCheck> check_view(const LatticeView& view);

// "tags 3, 7", those that are displaced in more than half of the pictures (at least two) that show them; or empty.
std::string displaced_tags(const TagLattice& tags, const TagLayout& board, const std::vector<LatticeView>& views);

}  // namespace calibration

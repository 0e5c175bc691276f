// Printed corners on a regular lattice and their positions in pictures, which the lens calibration works on.
//
// Node (column, row) lies at (column, row) * spacing: rows count upwards, so that with +x right and +y up the lattice's
// +z points towards the viewer. A chessboard's inner corners fill their lattice; on a tag board whose gap is a simple
// fraction of the tag, the tags' corners lie on some of its nodes.
#pragma once

#include <Eigen/Geometry>
#include <optional>
#include <string>
#include <vector>

#include "calibration/geometry/tags.h"

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

using BoardPicture = std::vector<LatticeCorner>;  // the corners seen in one picture

// The lattice on which a tag board's corners lie, and its frame.
struct TagLattice {
  Lattice lattice;
  Eigen::Isometry3d lattice_from_board = Eigen::Isometry3d::Identity();
};

// The lattice of a tag board. Throws std::runtime_error when the tags do not lie upright in one plane or no spacing
// down to a twentieth of a tag fits all of them.
TagLattice lattice_of(const TagLayout& board);

// The corners of the seen tags as lattice corners; tags that the board does not have are left out. Throws
// std::runtime_error on corners that are not finite numbers.
BoardPicture on_lattice(const TagLattice& tags, const TagLayout& board, const TagObservation& seen);

// How a picture contradicts a board: it is mirrored, or corners lie elsewhere than on the print.
struct BoardCheck {
  bool mirrored = false;        // true: right and left are exchanged
  std::vector<bool> displaced;  // one per corner; true: off by more than a lattice spacing
};

// Checks a picture by the plane-to-plane mapping on which most corners agree; std::nullopt for fewer than 8 corners or
// when less than half agree on one. Lens distortion of up to a tenth of a spacing across the board does not matter.
std::optional<BoardCheck> check_board(const BoardPicture& picture);

// The tags, as "tags 3, 7", that are displaced in more than half of the pictures that show them and in at least two;
// empty when there are none.
std::string displaced_tags(const TagLattice& tags, const TagLayout& board, const std::vector<BoardPicture>& pictures);

// The tags, as "tags 12, 13", that the layout does not have but that lie on its print: at the same place of its plane,
// to a quarter of a tag, in at least three pictures and in most that show them. Empty when there are none.
std::string tags_beside(const TagLayout& board, const std::vector<TagObservation>& pictures);

}  // namespace calibration

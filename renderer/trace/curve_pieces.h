// Curves cut into pieces that are nearly straight, as the kernels meet them (kernel_pieces.h).
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <limits>
#include <vector>

#include "renderer/trace/kernel_pieces.h"

namespace renderer {

// A part of a segment, with the cylinder around it.
struct CurvePiece {
  std::uint32_t segment = 0;
  double from = 0, to = 1;
  Eigen::Vector3d base = Eigen::Vector3d::Zero(), axis = Eigen::Vector3d::UnitX();
  double radius = 0, low = 0, high = 0;
  double length = 1;  // of its chord
  double deviation = 0,
         lean = 0;   // largest distance of the line from the axis; largest reach of its discs along the axis
  double taper = 0;  // radius times the widening
  double thickest = 0, tilt = 0;
};

// The segment of a uniform cubic B-spline with these four control points (x, y, z, radius) in powers of its parameter.
CurveSegment segment_of(const Eigen::Vector4f* control);

// The pieces of that segment: the whole of it, or as many equal parts as are nearly straight each, and whose length
// across the coordinate axis that it runs along is at most `most_oblique` radii, so that its box is not much larger
// than itself. The segment is number `segment` among all.
std::vector<CurvePiece> pieces_of(const Eigen::Vector4f* control, std::uint32_t segment,
                                  double most_oblique = std::numeric_limits<double>::infinity());

// The piece of that segment between these parameters.
CurvePiece piece_of(const Eigen::Vector4f* control, std::uint32_t segment, double from, double to);

// The box of the piece, its radius multiplied by `wider`.
Eigen::AlignedBox3d box_of(const CurvePiece& piece, double wider = 1);

// Whether the kernels of the newest processors can run on this one.
bool runs_newest_kernels();

// Pieces that no ray meets, and one lane of them made a piece.
CurvePieces no_pieces();
void put(CurvePieces& group, int lane, const CurvePiece& piece);

}  // namespace renderer

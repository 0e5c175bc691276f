// Curves as the kernels (yarn_grid_kernel.h, curve_tree_kernel.h) meet them. Plain numbers only, because inline
// functions of other headers would end up in the program compiled for the newest processor.
#pragma once

#include <cstddef>
#include <cstdint>

namespace renderer {

inline constexpr int kPieceLanes = 8;

// Up to eight pieces of curves that lie near each other, each inside a cylinder with flat ends. With p the offset of a
// ray's origin from a piece's axis and d the ray's direction, a ray with p . d > `slack` + `axial_slack` |its axial
// speed| moves away from the axis and can only leave the curve there.
struct alignas(32) CurvePieces {
  float base_x[kPieceLanes], base_y[kPieceLanes], base_z[kPieceLanes];
  float axis_x[kPieceLanes], axis_y[kPieceLanes], axis_z[kPieceLanes];  // unit
  float radius2[kPieceLanes], low[kPieceLanes], high[kPieceLanes];      // ends, along the axis from the base
  float slack[kPieceLanes], axial_slack[kPieceLanes], inverse_length[kPieceLanes];
  std::uint32_t segment[kPieceLanes];        // number among all segments
  float from[kPieceLanes], to[kPieceLanes];  // parameters on the segment
  float unstretch_x, unstretch_y;            // the pieces are round where space is multiplied by this
};

// A segment of a curve as a cubic in powers of its parameter: x, y, z and radius, in the space where the curve is
// round.
struct alignas(16) CurveSegment {
  float power[4][4];
};

}  // namespace renderer

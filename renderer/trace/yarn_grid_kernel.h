// The interface of yarn_grid_kernel.cpp, which is compiled once for each kind of processor. It has plain numbers only,
// because inline functions of other headers would end up in the program compiled for the newest of them.
#pragma once

#include <cstddef>
#include <cstdint>

namespace renderer {

inline constexpr int kGridLanes = 8;

// Up to eight pieces of yarn in one cell of the grid, each inside a cylinder with flat ends. With p the offset of a
// ray's origin from a piece's axis and d the ray's direction, a ray with p . d > `slack` + `axial_slack` |its axial
// speed| moves away from the axis and can only leave the yarn there.
struct alignas(32) YarnPieces {
  float base_x[kGridLanes], base_y[kGridLanes], base_z[kGridLanes];
  float axis_x[kGridLanes], axis_y[kGridLanes], axis_z[kGridLanes];  // unit
  float radius2[kGridLanes], low[kGridLanes], high[kGridLanes];      // ends, along the axis from the base
  float slack[kGridLanes], axial_slack[kGridLanes], inverse_length[kGridLanes];
  std::uint32_t segment[kGridLanes];       // number of the segment in the grid
  float from[kGridLanes], to[kGridLanes];  // parameters on the segment
  float unstretch_x, unstretch_y;          // the pieces are round where space is multiplied by this
};

// A segment of a yarn as a cubic in powers of its parameter: x, y, z and radius, in the space where the yarn is round.
struct alignas(16) YarnSegment {
  float power[4][4];
};

struct YarnGridData {
  int cells_x, cells_y;
  float cell_x, cell_y;        // mm
  double period_x, period_y;   // cells_x cell_x, cells_y cell_y
  const std::uint32_t* first;  // index of each cell's first pieces, row by row, and at the end the size of `pieces`
  const YarnPieces* pieces;
  const YarnSegment* segments;
};

struct YarnGridRay {
  double origin[3], direction[3];  // in the endless patch; the direction's length is near 1
  float length;
  float spread[2], growth[2];  // Spread of spread.h, where the ray is
};

struct YarnGridHit {
  std::uint32_t segment;
  float u;
  float distance;         // from the ray's origin
  float from_wrap;        // from `origin` below
  double tile_x, tile_y;  // whole periods between the endless patch and the cell
  float origin[3];        // where the ray began or last entered the cell that repeats, in that cell
  float normal[3];        // where the yarn is round, not unit
};

struct YarnGridKernel {
  bool (*nearest)(const YarnGridData&, const YarnGridRay&, YarnGridHit&);
  bool (*occluded)(const YarnGridData&, const YarnGridRay&);
};

namespace baseline {
extern const YarnGridKernel kYarnGridKernel;
}
#if defined(__x86_64__)
namespace avx2 {
extern const YarnGridKernel kYarnGridKernel;
}
#endif

}  // namespace renderer

// The interface of yarn_grid_kernel.cpp, which is compiled once for each kind of processor. It has plain numbers only
// (kernel_pieces.h).
#pragma once

#include "renderer/trace/kernel_pieces.h"

namespace renderer {

struct YarnGridData {
  int cells_x, cells_y;
  float cell_x, cell_y;        // mm
  double period_x, period_y;   // cells_x cell_x, cells_y cell_y
  const std::uint32_t* first;  // index of each cell's first pieces, row by row, and at the end the size of `pieces`
  const CurvePieces* pieces;
  const CurveSegment* segments;
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

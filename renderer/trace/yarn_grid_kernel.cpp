// The intersection of rays with the grid of yarn_grid.h: cells are walked along the ray.
#include "renderer/trace/yarn_grid_kernel.h"

#include "renderer/trace/piece_solver.h"

namespace renderer::KERNEL_NAMESPACE {
namespace {

INLINE Stretch stretch_of(const YarnGridRay& ray, const CurvePieces& p) {
  return {.middle = Float4{ray.spread[0], ray.spread[1], 1, 1},
          .growth = Float4{ray.growth[0], ray.growth[1], 0, 0},
          .curvature = Float4{ray.growth[0] / (ray.spread[0] * p.unstretch_x * p.unstretch_x),
                              ray.growth[1] / (ray.spread[1] * p.unstretch_y * p.unstretch_y), 0, 0}};
}

// Walks the cells to the nearest hit, or with `any` to the first that is found.
template <bool any, bool spread>
INLINE bool walk(const YarnGridData& grid, const YarnGridRay& ray, YarnGridHit* hit) {
  double tile_x = __builtin_floor(ray.origin[0] / grid.period_x),
         tile_y = __builtin_floor(ray.origin[1] / grid.period_y);
  double wrap = 0;  // distance of the local origin along the ray
  Float4 o = {static_cast<float>(ray.origin[0] - tile_x * grid.period_x),
              static_cast<float>(ray.origin[1] - tile_y * grid.period_y), static_cast<float>(ray.origin[2]), 0};
  const Float4 d = {static_cast<float>(ray.direction[0]), static_cast<float>(ray.direction[1]),
                    static_cast<float>(ray.direction[2]), 0};
  const float inv_x = d[0] != 0 ? 1 / d[0] : kFar, inv_y = d[1] != 0 ? 1 / d[1] : kFar;
  int ix = static_cast<int>(o[0] / grid.cell_x), iy = static_cast<int>(o[1] / grid.cell_y);
  ix = ix < 0 ? 0 : (ix < grid.cells_x ? ix : grid.cells_x - 1);
  iy = iy < 0 ? 0 : (iy < grid.cells_y ? iy : grid.cells_y - 1);
  const int forward_x = d[0] > 0, forward_y = d[1] > 0;
  float best = ray.length;  // from the local origin
  bool found = false;
  for (;;) {
    const float leave_x = d[0] != 0 ? (static_cast<float>(ix + forward_x) * grid.cell_x - o[0]) * inv_x : kFar;
    const float leave_y = d[1] != 0 ? (static_cast<float>(iy + forward_y) * grid.cell_y - o[1]) * inv_y : kFar;
    const float leave = leave_x < leave_y ? leave_x : leave_y;
    const std::uint32_t* first = grid.first + iy * grid.cells_x + ix;
    for (std::uint32_t i = first[0]; i < first[1]; ++i) {
      const CurvePieces& pieces = grid.pieces[i];
      const Float4 unstretch = {pieces.unstretch_x, pieces.unstretch_y, 1, 0};
      const LocalRay local{o * unstretch, d * unstretch};
      const Stretch stretch = stretch_of(ray, pieces);
      Approach approach;
      const float reach = leave + 1e-3f < best ? leave + 1e-3f : best;
      for (unsigned bits = candidates<spread>(pieces, local, stretch, reach, approach); bits; bits &= bits - 1) {
        const int lane = __builtin_ctz(bits);
        Solution solution;
        if (approach.near[lane] > best ||
            !solve<spread>(grid.segments, pieces, lane, approach, local, stretch, best, solution))
          continue;
        if (any) return true;
        found = true;
        best = solution.t;
        hit->segment = pieces.segment[lane];
        hit->u = solution.u;
        hit->from_wrap = solution.t;
        hit->distance = static_cast<float>(wrap + static_cast<double>(solution.t));
        hit->tile_x = tile_x, hit->tile_y = tile_y;
        for (int k = 0; k < 3; ++k) hit->origin[k] = o[k], hit->normal[k] = solution.normal[k];
      }
    }
    if (!(leave < best)) return found;
    if (leave_x < leave_y)
      ix += forward_x ? 1 : -1;
    else
      iy += forward_y ? 1 : -1;
    if (ix >= 0 && ix < grid.cells_x && iy >= 0 && iy < grid.cells_y) continue;
    // The ray enters the next period: the same cells again, from a new origin.
    if (ix < 0) tile_x -= 1, ix = grid.cells_x - 1;
    if (ix >= grid.cells_x) tile_x += 1, ix = 0;
    if (iy < 0) tile_y -= 1, iy = grid.cells_y - 1;
    if (iy >= grid.cells_y) tile_y += 1, iy = 0;
    wrap += static_cast<double>(leave);
    best -= leave;
    o = Float4{static_cast<float>(ray.origin[0] + wrap * ray.direction[0] - tile_x * grid.period_x),
               static_cast<float>(ray.origin[1] + wrap * ray.direction[1] - tile_y * grid.period_y),
               static_cast<float>(ray.origin[2] + wrap * ray.direction[2]), 0};
  }
}

INLINE bool is_spread(const YarnGridRay& ray) {
  return ray.spread[0] != 1 || ray.spread[1] != 1 || ray.growth[0] != 0 || ray.growth[1] != 0;
}

bool nearest(const YarnGridData& grid, const YarnGridRay& ray, YarnGridHit& hit) {
  return is_spread(ray) ? walk<false, true>(grid, ray, &hit) : walk<false, false>(grid, ray, &hit);
}

bool occluded(const YarnGridData& grid, const YarnGridRay& ray) {
  return is_spread(ray) ? walk<true, true>(grid, ray, nullptr) : walk<true, false>(grid, ray, nullptr);
}

}  // namespace

extern const YarnGridKernel kYarnGridKernel;
const YarnGridKernel kYarnGridKernel{nearest, occluded};

}  // namespace renderer::KERNEL_NAMESPACE

// The yarns of one patch in a grid of cells that repeats with it: rays meet the endless cloth, at the cost of the few
// pieces of yarn that lie on their way.
//
// Rays inside a cloth are short and meet something after a yarn or two. In a flat grid with cells of about a radius
// they find the few pieces that can be met in one or two groups of eight, and a ray that leaves the patch on one side
// comes in on the other. Embree's tree of round curves, which serves any curves, takes ten times as long here
// (tests/bench/bench_cloth.cpp).
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <vector>

#include "renderer/scene/scene.h"
#include "renderer/trace/spread.h"
#include "renderer/trace/yarn_grid_kernel.h"

namespace renderer {

// The yarns of one thread and section, of whichever period, that reach into the cell [0, period).
struct ColumnYarns {
  CurveSet curves;  // CurveSet::placed at most stretches in x and y
  std::uint32_t thread;
};

class YarnGrid {
 public:
  struct Hit {
    std::uint32_t yarns, segment;  // index in the list that the grid was made of; segment of that curve set
    float u;                       // parameter on the segment
    float distance;                // along the ray, from its origin
    Eigen::Vector3d tile;          // whole periods between the endless patch and the cell
    Eigen::Vector3f origin;        // a point on the ray, moved into the cell that repeats
    float from_origin;             // along the ray, from that point to the hit
    Eigen::Vector3f normal;        // outwards where the curves are round, not unit
  };

  // `least_spread`: the smallest spread that any ray will have.
  YarnGrid(const std::vector<ColumnYarns>& yarns, const Eigen::Vector2d& period_mm, float least_spread = 1);

  // The first place within `length` where the ray enters a yarn. The ray is given in the endless patch; its direction
  // need not be a unit vector, and it leaves yarns in which it starts without a hit. The hits are those of Embree's
  // round curves, which Embree finds to 0.002 radii and this grid to 0.0002. `spread`: the cloth's where the ray is;
  // yarns are as thick in the world as on a flat surface, whatever the patch is stretched by there.
  std::optional<Hit> nearest(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction, float length,
                             const Spread& spread = {}) const;
  bool occluded(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction, float length,
                const Spread& spread = {}) const;

  // Bytes of the grid without the yarns themselves.
  std::size_t bytes() const;
  // The mean number of groups of eight pieces in a cell.
  double groups_per_cell() const;

 private:
  YarnGridData data() const;

  const YarnGridKernel* kernel_;
  Eigen::Vector2d period_mm_;
  Eigen::Vector2i cells_;
  std::vector<std::uint32_t> first_;
  std::vector<CurvePieces> pieces_;
  std::vector<CurveSegment> segments_;
  struct Origin {
    std::uint32_t yarns, segment;
  };
  std::vector<Origin> origins_;  // of segments_
};

}  // namespace renderer

// The yarns of one patch in a grid of cells that repeats with it: rays meet the endless cloth, at the cost of the few pieces
// of yarn that lie on their way.
//
// Rays inside a cloth are short and meet something after a yarn or two; a flat grid with cells of about a radius then has
// the few pieces that can be met in one or two groups of eight, and a ray that leaves the patch at one side comes in at the
// other. Embree's tree of round curves, which serves any curves, is met a tenth as fast here (tests/bench/bench_cloth.cpp).
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <vector>

#include "renderer/scene.h"
#include "renderer/yarn_grid_kernel.h"

namespace renderer {

// Yarns of one thread and section, of whichever period, that reach into the cell [0, period).
struct ColumnYarns {
  CurveSet curves;  // placed: at most stretched in x and y
  std::uint32_t thread;
};

class YarnGrid {
 public:
  struct Hit {
    std::uint32_t yarns, segment;  // of the list that the grid was made of, of its curve set
    float u;                       // on the segment
    float distance;                // along the ray
    Eigen::Vector3d tile;          // whole periods between the endless patch and the cell
    Eigen::Vector3f origin;        // on the ray, in the cell that repeats; from there
    float from_origin;             // the hit is so far
    Eigen::Vector3f normal;        // outwards where the curves are round, not unit
  };

  YarnGrid(const std::vector<ColumnYarns>& yarns, const Eigen::Vector2d& period_mm);

  // The first place within `length` where the ray enters a yarn. The ray lies in the endless patch; its direction need not
  // be a unit vector, and yarns that it starts in let it out. Hits are those of Embree's round curves, which are found to
  // 0.002 radii there and to 0.0002 here.
  std::optional<Hit> nearest(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction, float length) const;
  bool occluded(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction, float length) const;

  // Of everything but the yarns themselves.
  std::size_t bytes() const;
  // Mean number of groups of eight pieces in a cell.
  double groups_per_cell() const;

 private:
  YarnGridData data() const;

  const YarnGridKernel* kernel_;
  Eigen::Vector2d period_mm_;
  Eigen::Vector2i cells_;
  std::vector<std::uint32_t> first_;
  std::vector<YarnPieces> pieces_;
  std::vector<YarnSegment> segments_;
  struct Origin {
    std::uint32_t yarns, segment;
  };
  std::vector<Origin> origins_;  // of segments_
};

}  // namespace renderer

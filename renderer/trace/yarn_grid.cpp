#include "renderer/trace/yarn_grid.h"

#include <algorithm>
#include <cmath>

#include "renderer/trace/curve_pieces.h"

namespace renderer {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using Eigen::Vector3f;

constexpr double kCellRadii = 1.0;  // size of a cell, in mean radii of the yarns
constexpr int kMostCells = 512;     // along each side

const YarnGridKernel& best_kernel() {
#if defined(__x86_64__)
  if (runs_newest_kernels()) return avx2::kYarnGridKernel;
#endif
  return baseline::kYarnGridKernel;
}

// Thick yarns count for more than fibers that stand out of them.
double mean_radius(const std::vector<ColumnYarns>& yarns) {
  double squares = 0, sum = 0;
  for (const ColumnYarns& part : yarns)
    for (const Eigen::Vector4f& point : part.curves.control_points) {
      const auto radius = static_cast<double>(point.w());
      squares += radius * radius, sum += radius;
    }
  return sum > 0 ? squares / sum : 1;
}

}  // namespace

YarnGrid::YarnGrid(const std::vector<ColumnYarns>& yarns, const Vector2d& period_mm, float least_spread)
    : kernel_(&best_kernel()), period_mm_(period_mm) {
  const double size = kCellRadii * mean_radius(yarns);
  for (int axis = 0; axis < 2; ++axis)
    cells_[axis] = std::clamp(static_cast<int>(std::lround(period_mm[axis] / size)), 1, kMostCells);
  const Eigen::Array2d cell = period_mm.array() / cells_.cast<double>().array();
  struct Placed {
    CurvePiece piece;
    Vector3f stretch;
  };
  std::vector<std::vector<Placed>> of_cells(static_cast<std::size_t>(cells_.prod()));
  for (std::uint32_t part = 0; part < yarns.size(); ++part) {
    const CurveSet& curves = yarns[part].curves;
    const Vector3f stretch = curves.placed.linear().diagonal();
    for (std::uint32_t s = 0; s < curves.segments.size(); ++s) {
      const Eigen::Vector4f* control = &curves.control_points[curves.segments[s]];
      const auto number = static_cast<std::uint32_t>(segments_.size());
      segments_.push_back(segment_of(control));
      origins_.push_back({part, s});
      for (const CurvePiece& piece : pieces_of(control, number)) {
        const Eigen::AlignedBox3d box = box_of(piece, 1 / static_cast<double>(least_spread));
        const auto cell_at = [&](const Vector3d& corner) -> Eigen::Array2d {
          return (corner.head<2>().array() * stretch.head<2>().cast<double>().array() / cell).floor();
        };
        const Eigen::Array2i low = cell_at(box.min()).max(0.0).min(double{kMostCells}).cast<int>(),
                             high = cell_at(box.max()).max(-1.0).min(double{kMostCells}).cast<int>();
        for (int y = low.y(); y <= std::min(high.y(), cells_.y() - 1); ++y)
          for (int x = low.x(); x <= std::min(high.x(), cells_.x() - 1); ++x)
            of_cells[static_cast<std::size_t>(y * cells_.x() + x)].push_back({piece, stretch});
      }
    }
  }
  for (const std::vector<Placed>& placed : of_cells) {
    first_.push_back(static_cast<std::uint32_t>(pieces_.size()));
    int lane = kPieceLanes;
    const Placed* before = nullptr;
    for (const Placed& next : placed) {
      if (lane == kPieceLanes || next.stretch != before->stretch) {
        CurvePieces& group = pieces_.emplace_back(no_pieces());
        group.unstretch_x = 1 / next.stretch.x(), group.unstretch_y = 1 / next.stretch.y();
        lane = 0;
      }
      put(pieces_.back(), lane++, next.piece);
      before = &next;
    }
  }
  first_.push_back(static_cast<std::uint32_t>(pieces_.size()));
}

YarnGridData YarnGrid::data() const {
  return {.cells_x = cells_.x(),
          .cells_y = cells_.y(),
          .cell_x = static_cast<float>(period_mm_.x() / cells_.x()),
          .cell_y = static_cast<float>(period_mm_.y() / cells_.y()),
          .period_x = period_mm_.x(),
          .period_y = period_mm_.y(),
          .first = first_.data(),
          .pieces = pieces_.data(),
          .segments = segments_.data()};
}

namespace {

YarnGridRay grid_ray(const Vector3d& origin, const Vector3d& direction, float length, const Spread& spread) {
  return {{origin.x(), origin.y(), origin.z()},
          {direction.x(), direction.y(), direction.z()},
          length,
          {spread.middle.x(), spread.middle.y()},
          {spread.growth.x(), spread.growth.y()}};
}

}  // namespace

std::optional<YarnGrid::Hit> YarnGrid::nearest(const Vector3d& origin, const Vector3d& direction, float length,
                                               const Spread& spread) const {
  YarnGridHit hit;
  if (!kernel_->nearest(data(), grid_ray(origin, direction, length, spread), hit)) return std::nullopt;
  return Hit{.yarns = origins_[hit.segment].yarns,
             .segment = origins_[hit.segment].segment,
             .u = hit.u,
             .distance = hit.distance,
             .tile = {hit.tile_x * period_mm_.x(), hit.tile_y * period_mm_.y(), 0},
             .origin = {hit.origin[0], hit.origin[1], hit.origin[2]},
             .from_origin = hit.from_wrap,
             .normal = {hit.normal[0], hit.normal[1], hit.normal[2]}};
}

bool YarnGrid::occluded(const Vector3d& origin, const Vector3d& direction, float length, const Spread& spread) const {
  return kernel_->occluded(data(), grid_ray(origin, direction, length, spread));
}

std::size_t YarnGrid::bytes() const {
  return first_.size() * sizeof(first_[0]) + pieces_.size() * sizeof(pieces_[0]) +
         segments_.size() * sizeof(segments_[0]) + origins_.size() * sizeof(origins_[0]);
}

double YarnGrid::groups_per_cell() const {
  return static_cast<double>(pieces_.size()) / static_cast<double>(first_.size() - 1);
}

}  // namespace renderer

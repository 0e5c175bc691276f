#include "renderer/trace/yarn_grid.h"

#include <algorithm>
#include <cmath>

namespace renderer {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using Eigen::Vector3f;

constexpr double kCellRadii = 1.0;       // size of a cell, in mean radii of the yarns
constexpr int kMostCells = 512;          // along each side
constexpr double kMostDeviation = 0.05;  // of a piece from its axis, in radii
constexpr double kMostTilt = 0.4;        // of a piece from its axis, rad
constexpr int kMostParts = 64;           // of a segment
constexpr double kWider = 1e-3;          // of cylinders, in radii: their size is found at a few places only

const YarnGridKernel& best_kernel() {
#if defined(__x86_64__)
  if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma")) return avx2::kYarnGridKernel;
#endif
  return baseline::kYarnGridKernel;
}

// One segment in powers of its parameter.
struct Cubic {
  Eigen::Vector4d power[4];

  explicit Cubic(const Eigen::Vector4f* control) {
    const Eigen::Vector4d a = control[0].cast<double>(), b = control[1].cast<double>(), c = control[2].cast<double>(),
                          d = control[3].cast<double>();
    power[0] = (a + 4 * b + c) / 6;
    power[1] = (c - a) / 2;
    power[2] = (a - 2 * b + c) / 2;
    power[3] = (d - a + 3 * (b - c)) / 6;
  }
  Eigen::Vector4d at(double u) const { return power[0] + u * (power[1] + u * (power[2] + u * power[3])); }
  Eigen::Vector4d derivative(double u) const { return power[1] + u * (2 * power[2] + 3 * u * power[3]); }
  Vector3d tangent(double u) const { return derivative(u).head<3>().normalized(); }
  // The change of the radius per length along the line, its magnitude.
  double widening(double u) const { return std::abs(derivative(u).w()) / derivative(u).head<3>().norm(); }
};

// A part of a segment, with the cylinder around it.
struct Piece {
  std::uint32_t segment = 0;
  double from = 0, to = 1;
  Vector3d base = Vector3d::Zero(), axis = Vector3d::UnitX();
  double radius = 0, low = 0, high = 0;
  double length = 1;  // of its chord
  double deviation = 0,
         lean = 0;   // largest distance of the line from the axis; largest reach of its discs along the axis
  double taper = 0;  // radius times the widening
  double thickest = 0, tilt = 0;
};

Piece piece_of(const Cubic& line, double from, double to) {
  constexpr int kSteps = 8;
  Piece piece{.from = from, .to = to, .base = line.at(from).head<3>()};
  const Vector3d chord = line.at(to).head<3>() - piece.base;
  piece.axis = chord.norm() > 0 ? Vector3d(chord.normalized()) : line.tangent(from);
  piece.length = std::max(chord.norm(), 1e-9);
  piece.low = 1e300, piece.high = -1e300;
  for (int i = 0; i <= kSteps; ++i) {
    const double u = from + (to - from) * i / kSteps;
    const Eigen::Vector4d p = line.at(u);
    const Vector3d offset = p.head<3>() - piece.base;
    const double along = offset.dot(piece.axis), away = (offset - along * piece.axis).norm(), r = p.w();
    const double sine = line.tangent(u).cross(piece.axis).norm(), lean = r * std::min(1.0, sine);
    piece.low = std::min(piece.low, along - lean), piece.high = std::max(piece.high, along + lean);
    piece.radius = std::max(piece.radius, away + r);
    piece.deviation = std::max(piece.deviation, away), piece.lean = std::max(piece.lean, lean);
    piece.taper = std::max(piece.taper, r * line.widening(u));
    piece.thickest = std::max(piece.thickest, r), piece.tilt = std::max(piece.tilt, std::asin(std::min(1.0, sine)));
  }
  const double more = kWider * piece.thickest + 0.05 * piece.deviation;
  piece.radius += more, piece.low -= more, piece.high += more;
  return piece;
}

// The pieces of a segment: the whole of it, or as many equal parts as are nearly straight each.
std::vector<Piece> pieces_of(const Cubic& line, std::uint32_t segment) {
  for (int parts = 1;; parts *= 2) {
    std::vector<Piece> pieces;
    bool straight = true;
    for (int i = 0; i < parts; ++i) {
      pieces.push_back(piece_of(line, static_cast<double>(i) / parts, static_cast<double>(i + 1) / parts));
      pieces.back().segment = segment;
      straight &= pieces.back().deviation <= kMostDeviation * pieces.back().thickest && pieces.back().tilt <= kMostTilt;
    }
    if (straight || parts >= kMostParts) return pieces;
  }
}

// The box of the piece in x and y of the cloth.
Eigen::AlignedBox2d box_of(const Piece& piece, const Vector3f& stretch, double least_spread) {
  Eigen::AlignedBox2d box;
  const Eigen::Array2d half = piece.radius / least_spread * (1 - piece.axis.head<2>().array().square()).max(0.0).sqrt();
  const Vector2d scale = stretch.head<2>().cast<double>();
  for (const double end : {piece.low, piece.high}) {
    const Eigen::Array2d at = (piece.base + end * piece.axis).head<2>().array();
    box.extend(Vector2d(at - half).cwiseProduct(scale)).extend(Vector2d(at + half).cwiseProduct(scale));
  }
  return box;
}

void put(YarnPieces& group, int lane, const Piece& p) {
  const Vector3f base = p.base.cast<float>(), axis = p.axis.cast<float>();
  group.base_x[lane] = base.x(), group.base_y[lane] = base.y(), group.base_z[lane] = base.z();
  group.axis_x[lane] = axis.x(), group.axis_y[lane] = axis.y(), group.axis_z[lane] = axis.z();
  group.radius2[lane] = static_cast<float>(p.radius * p.radius);
  group.low[lane] = static_cast<float>(p.low), group.high[lane] = static_cast<float>(p.high);
  // The slacks have room for rounding, and for directions that are longer than 1 in the patch because the surface is
  // stretched.
  group.slack[lane] = static_cast<float>(1.5 * p.deviation + kWider * p.thickest);
  group.axial_slack[lane] = static_cast<float>(1.05 * p.lean + 3 * p.taper);
  group.inverse_length[lane] = static_cast<float>(1 / p.length);
  group.segment[lane] = p.segment;
  group.from[lane] = static_cast<float>(p.from), group.to[lane] = static_cast<float>(p.to);
}

// Makes a lane that no ray meets.
void leave_empty(YarnPieces& group, int lane) {
  put(group, lane, Piece{});
  group.radius2[lane] = -1, group.slack[lane] = -1e30f;
}

double mean_radius(const std::vector<ColumnYarns>& yarns) {
  double sum = 0, count = 0;
  for (const ColumnYarns& part : yarns)
    for (const Eigen::Vector4f& point : part.curves.control_points) sum += static_cast<double>(point.w()), ++count;
  return count > 0 ? sum / count : 1;
}

}  // namespace

YarnGrid::YarnGrid(const std::vector<ColumnYarns>& yarns, const Vector2d& period_mm, float least_spread)
    : kernel_(&best_kernel()), period_mm_(period_mm) {
  const double size = kCellRadii * mean_radius(yarns);
  for (int axis = 0; axis < 2; ++axis)
    cells_[axis] = std::clamp(static_cast<int>(std::lround(period_mm[axis] / size)), 1, kMostCells);
  const Eigen::Array2d cell = period_mm.array() / cells_.cast<double>().array();
  struct Placed {
    Piece piece;
    Vector3f stretch;
  };
  std::vector<std::vector<Placed>> of_cells(static_cast<std::size_t>(cells_.prod()));
  for (std::uint32_t part = 0; part < yarns.size(); ++part) {
    const CurveSet& curves = yarns[part].curves;
    const Vector3f stretch = curves.placed.linear().diagonal();
    for (std::uint32_t s = 0; s < curves.segments.size(); ++s) {
      const Cubic line(&curves.control_points[curves.segments[s]]);
      const auto number = static_cast<std::uint32_t>(segments_.size());
      YarnSegment& segment = segments_.emplace_back();
      for (int k = 0; k < 4; ++k) Eigen::Map<Eigen::Vector4f>(segment.power[k]) = line.power[k].cast<float>();
      origins_.push_back({part, s});
      for (const Piece& piece : pieces_of(line, number)) {
        const Eigen::AlignedBox2d box = box_of(piece, stretch, static_cast<double>(least_spread));
        const Eigen::Array2i low = (box.min().array() / cell).floor().max(0.0).min(double{kMostCells}).cast<int>(),
                             high = (box.max().array() / cell).floor().max(-1.0).min(double{kMostCells}).cast<int>();
        for (int y = low.y(); y <= std::min(high.y(), cells_.y() - 1); ++y)
          for (int x = low.x(); x <= std::min(high.x(), cells_.x() - 1); ++x)
            of_cells[static_cast<std::size_t>(y * cells_.x() + x)].push_back({piece, stretch});
      }
    }
  }
  for (const std::vector<Placed>& placed : of_cells) {
    first_.push_back(static_cast<std::uint32_t>(pieces_.size()));
    int lane = kGridLanes;
    const Placed* before = nullptr;
    for (const Placed& next : placed) {
      if (lane == kGridLanes || next.stretch != before->stretch) {
        YarnPieces& group = pieces_.emplace_back();
        for (int i = 0; i < kGridLanes; ++i) leave_empty(group, i);
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

#include "renderer/trace/curve_pieces.h"

#include <algorithm>
#include <cmath>

namespace renderer {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;

constexpr double kMostDeviation = 0.05;  // of a piece from its axis, in radii
constexpr double kMostTilt = 0.4;        // of a piece from its axis, rad
constexpr int kMostParts = 64;           // of a segment
constexpr double kWider = 1e-3;          // of cylinders, in radii: their size is found at a few places only

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

CurvePiece piece_of_line(const Cubic& line, std::uint32_t segment, double from, double to) {
  constexpr int kSteps = 8;
  CurvePiece piece{.segment = segment, .from = from, .to = to, .base = line.at(from).head<3>()};
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

// The length across the coordinate axis that the piece runs along most.
double oblique_length(const CurvePiece& piece) {
  const double along = piece.axis.cwiseAbs().maxCoeff();
  return piece.length * std::sqrt(std::max(0.0, 1 - along * along));
}

}  // namespace

CurveSegment segment_of(const Eigen::Vector4f* control) {
  const Cubic line(control);
  CurveSegment segment;
  for (int k = 0; k < 4; ++k) Eigen::Map<Eigen::Vector4f>(segment.power[k]) = line.power[k].cast<float>();
  return segment;
}

std::vector<CurvePiece> pieces_of(const Eigen::Vector4f* control, std::uint32_t segment, double most_oblique) {
  const Cubic line(control);
  for (int parts = 1;; parts *= 2) {
    std::vector<CurvePiece> pieces;
    bool fine = true;
    for (int i = 0; i < parts; ++i) {
      CurvePiece& piece = pieces.emplace_back(
          piece_of_line(line, segment, static_cast<double>(i) / parts, static_cast<double>(i + 1) / parts));
      fine &= piece.deviation <= kMostDeviation * piece.thickest && piece.tilt <= kMostTilt &&
              oblique_length(piece) <= most_oblique * piece.thickest;
    }
    if (fine || parts >= kMostParts) return pieces;
  }
}

CurvePiece piece_of(const Eigen::Vector4f* control, std::uint32_t segment, double from, double to) {
  return piece_of_line(Cubic(control), segment, from, to);
}

Eigen::AlignedBox3d box_of(const CurvePiece& piece, double wider) {
  const Vector3d half = piece.radius * wider * (1 - piece.axis.array().square()).max(0.0).sqrt();
  Eigen::AlignedBox3d box;
  for (const double end : {piece.low, piece.high}) {
    const Vector3d at = piece.base + end * piece.axis;
    box.extend(Vector3d(at - half)).extend(Vector3d(at + half));
  }
  return box;
}

bool runs_newest_kernels() {
#if defined(__x86_64__)
  return __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma");
#else
  return false;
#endif
}

CurvePieces no_pieces() {
  CurvePieces group{};
  for (int lane = 0; lane < kPieceLanes; ++lane) {
    put(group, lane, CurvePiece{});
    group.radius2[lane] = -1, group.slack[lane] = -1e30f;
  }
  group.unstretch_x = group.unstretch_y = 1;
  return group;
}

void put(CurvePieces& group, int lane, const CurvePiece& p) {
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

}  // namespace renderer

#include "renderer/embroidery/digitise.h"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <utility>

#include "renderer/embroidery/stitch_curves.h"

namespace renderer {
namespace {

using Eigen::Vector2d;

constexpr double kLongestStitch_mm = 2.4, kMostSag_mm = 0.12;  // up to kLineStep_mm longer
constexpr double kSatinFrom_mm = 0.8, kSatinPitch_mm = 0.35;
constexpr double kCornerCosine = 0.9;
constexpr double kFillPitch_mm = 0.35, kFillStitch_mm = 4, kShortestRow_mm = 0.3;
constexpr double kLongestTurn_mm = 2;  // from the end of one row to the beginning of the next
constexpr int kFillOffsets = 4;        // of rows one after the other

bool corner(const std::vector<Vector2d>& line, std::size_t i) {
  if (i == 0 || i + 1 >= line.size()) return false;
  return (line[i] - line[i - 1]).normalized().dot((line[i + 1] - line[i]).normalized()) < kCornerCosine;
}

// The distance of point k from the straight stitch a - b.
double sag(const Vector2d& a, const Vector2d& b, const Vector2d& k) {
  const Vector2d along = b - a;
  const double length = along.norm();
  return length > 0 ? std::abs(along.x() * (k - a).y() - along.y() * (k - a).x()) / length : (k - a).norm();
}

// Stitches of a like length from corner to corner.
std::vector<Vector2d> running(const std::vector<Vector2d>& line) {
  std::vector<Vector2d> points{line.front()};
  for (std::size_t from = 0; from + 1 < line.size();) {
    std::size_t end = from + 1;
    double length = (line[end] - line[from]).norm();
    for (; end + 1 < line.size() && !corner(line, end); ++end) length += (line[end + 1] - line[end]).norm();
    const double most = length / std::ceil(length / kLongestStitch_mm) + kLineStep_mm;
    while (from < end) {
      std::size_t to = from + 1;
      for (bool fits = true; fits && to < end;) {
        fits = (line[to + 1] - line[from]).norm() <= most;
        for (std::size_t k = from + 1; fits && k <= to; ++k)
          fits = sag(line[from], line[to + 1], line[k]) <= kMostSag_mm;
        if (fits) ++to;
      }
      points.push_back(line[from = to]);
    }
  }
  return points;
}

std::vector<Vector2d> satin(const std::vector<Vector2d>& line, double width_mm) {
  std::vector<Vector2d> points;
  double gone = 0, next = 0;
  double side = 1;
  const auto put = [&](const Vector2d& at, const Vector2d& along) {
    points.emplace_back(at + side * width_mm / 2 * Vector2d(-along.y(), along.x()));
    side = -side;
  };
  for (std::size_t i = 0; i + 1 < line.size(); ++i) {
    const Vector2d step = line[i + 1] - line[i];
    const double length = step.norm();
    for (; next <= gone + length; next += kSatinPitch_mm / 2)
      put(line[i] + step * ((next - gone) / length), step / length);
    gone += length;
  }
  if (points.size() < 2) put(line.back(), (line.back() - line[line.size() - 2]).normalized());
  return points;
}

void require_few(std::size_t stitches, const std::string& source) {
  if (stitches > static_cast<std::size_t>(kMostStitches))
    throw std::runtime_error(source + ": would have more than a million stitches; make it smaller, or its lines fewer");
}

// The direction in which the shape's outline is spread most.
double longer_side_rad(const std::vector<std::vector<Vector2d>>& area) {
  Vector2d mean = Vector2d::Zero();
  double count = 0;
  for (const auto& outline : area)
    for (const Vector2d& point : outline) mean += point, ++count;
  mean /= count;
  Eigen::Matrix2d spread = Eigen::Matrix2d::Zero();
  for (const auto& outline : area)
    for (const Vector2d& point : outline) spread += (point - mean) * (point - mean).transpose();
  const Vector2d along = Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d>(spread).eigenvectors().col(1);
  return std::atan2(along.y(), along.x());
}

struct Piece {
  double from, to;  // along a row
};

// Where the row y = `height` runs inside of the shape.
std::vector<Piece> row_inside(const std::vector<std::vector<Vector2d>>& area, double height, bool even_odd) {
  std::vector<std::pair<double, int>> crossings;  // where an outline is crossed, and whether upwards
  for (const auto& outline : area)
    for (std::size_t i = 0; i < outline.size(); ++i) {
      const Vector2d &a = outline[i], &b = outline[(i + 1) % outline.size()];
      if ((a.y() <= height) == (b.y() <= height)) continue;
      crossings.emplace_back(a.x() + (height - a.y()) / (b.y() - a.y()) * (b.x() - a.x()), a.y() <= height ? 1 : -1);
    }
  std::ranges::sort(crossings);
  std::vector<Piece> pieces;
  int winding = 0;
  for (std::size_t i = 0; i + 1 < crossings.size(); ++i) {
    winding += even_odd ? 1 : crossings[i].second;
    const bool inside = even_odd ? winding % 2 != 0 : winding != 0;
    if (!inside) continue;
    const double from = crossings[i].first, to = crossings[i + 1].first;
    if (!pieces.empty() && from - pieces.back().to < 1e-9)
      pieces.back().to = to;
    else
      pieces.push_back({from, to});
  }
  std::erase_if(pieces, [](const Piece& piece) { return piece.to - piece.from < kShortestRow_mm; });
  return pieces;
}

// The needle goes along one row and back along the next, as long as that begins where the last one has ended; elsewhere
// the thread is cut and begins anew.
std::vector<std::vector<Vector2d>> filled(const ArtLine& shape, const std::string& source) {
  const double angle = shape.along_rad.value_or(longer_side_rad(shape.area));
  const Eigen::Rotation2Dd turned(-angle), back(angle);
  std::vector<std::vector<Vector2d>> area = shape.area;
  double low = std::numeric_limits<double>::infinity(), high = -low;
  for (auto& outline : area)
    for (Vector2d& point : outline) {
      point = turned * point;
      low = std::min(low, point.y()), high = std::max(high, point.y());
    }
  require_few(static_cast<std::size_t>((high - low) / kFillPitch_mm), source);
  struct Open {
    bool forwards;
    std::vector<Vector2d> points;
  };
  const auto is_beside = [&](const Vector2d& last, double along, double height) {
    return (turned * last - Vector2d(along, height)).norm() < kLongestTurn_mm;
  };
  std::vector<Open> open;
  std::vector<std::vector<Vector2d>> runs;
  std::size_t stitches = 0;
  int row = 0;
  for (double height = low + kFillPitch_mm / 2; height < high; height += kFillPitch_mm, ++row) {
    std::vector<Open> next;
    std::vector<bool> used(open.size(), false);
    for (const Piece& piece : row_inside(area, height, shape.even_odd)) {
      Open run{.forwards = row % 2 == 0, .points = {}};
      for (std::size_t i = 0; i < open.size(); ++i)
        if (!used[i] && is_beside(open[i].points.back(), open[i].forwards ? piece.to : piece.from, height)) {
          run.points = std::move(open[i].points), run.forwards = !open[i].forwards, used[i] = true;
          break;
        }
      // Needle points of a row lie on a grid that the next row has elsewhere, so that no furrow is seen.
      const double shift = kFillStitch_mm * (row % kFillOffsets) / kFillOffsets;
      std::vector<double> along{piece.from};
      for (double at = (std::floor((piece.from - shift) / kFillStitch_mm) + 1) * kFillStitch_mm + shift; at < piece.to;
           at += kFillStitch_mm)
        if (at - along.back() > kShortestRow_mm && piece.to - at > kShortestRow_mm) along.push_back(at);
      along.push_back(piece.to);
      if (!run.forwards) std::ranges::reverse(along);
      require_few(stitches += along.size(), source);
      for (const double at : along) run.points.emplace_back(back * Vector2d(at, height));
      next.push_back(std::move(run));
    }
    for (std::size_t i = 0; i < open.size(); ++i)
      if (!used[i]) runs.push_back(std::move(open[i].points));
    open = std::move(next);
  }
  for (Open& run : open) runs.push_back(std::move(run.points));
  return runs;
}

}  // namespace

Motif digitise(const LineArt& art, const std::string& source) {
  Motif motif{.name = art.name};
  std::size_t stitches = 0;
  for (const ArtLine& drawn : art.lines) {
    if (motif.threads.empty() || motif.threads.back().srgb != drawn.srgb) motif.threads.push_back({.srgb = drawn.srgb});
    std::vector<std::vector<Vector2d>> runs;
    if (!drawn.area.empty())
      runs = filled(drawn, source);
    else
      runs.push_back(drawn.width_mm < kSatinFrom_mm ? running(drawn.points) : satin(drawn.points, drawn.width_mm));
    for (std::vector<Vector2d>& points : runs) {
      require_few(stitches += points.size(), source);
      motif.runs.push_back({.thread = static_cast<int>(motif.threads.size()) - 1, .needle_points = std::move(points)});
    }
  }
  return motif;
}

}  // namespace renderer

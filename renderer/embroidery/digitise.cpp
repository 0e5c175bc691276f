#include "renderer/embroidery/digitise.h"

#include <cmath>
#include <stdexcept>

#include "renderer/embroidery/stitch_curves.h"

namespace renderer {
namespace {

using Eigen::Vector2d;

constexpr double kLongestStitch_mm = 2.4, kMostSag_mm = 0.12;  // up to kLineStep_mm longer
constexpr double kSatinFrom_mm = 0.8, kSatinPitch_mm = 0.35;
constexpr double kCornerCosine = 0.9;

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

}  // namespace

Motif digitise(const LineArt& art, const std::string& source) {
  Motif motif{.name = art.name};
  std::size_t stitches = 0;
  for (const auto& [srgb, width_mm, line] : art.lines) {
    if (motif.threads.empty() || motif.threads.back().srgb != srgb) motif.threads.push_back({.srgb = srgb});
    std::vector<Vector2d> points = width_mm < kSatinFrom_mm ? running(line) : satin(line, width_mm);
    stitches += points.size();
    if (stitches > static_cast<std::size_t>(kMostStitches))
      throw std::runtime_error(source +
                               ": would have more than a million stitches; make it smaller, or its lines fewer");
    motif.runs.push_back({.thread = static_cast<int>(motif.threads.size()) - 1, .needle_points = std::move(points)});
  }
  return motif;
}

}  // namespace renderer

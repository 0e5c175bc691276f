#include "calibration/geometry/tag_corners.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

namespace calibration {
namespace {

using Line = Eigen::Hyperplane<double, 2>;

std::optional<double> interpolated(const cv::Mat1f& grey, const Eigen::Vector2d& pixel) {
  const int column = static_cast<int>(std::floor(pixel.x())), row = static_cast<int>(std::floor(pixel.y()));
  if (column < 0 || row < 0 || column + 1 >= grey.cols || row + 1 >= grey.rows) return std::nullopt;
  const double x = pixel.x() - column, y = pixel.y() - row;
  const auto at = [&](int dy, int dx) { return static_cast<double>(grey(row + dy, column + dx)); };
  return (1 - y) * ((1 - x) * at(0, 0) + x * at(0, 1)) + y * ((1 - x) * at(1, 0) + x * at(1, 1));
}

struct Crossing {
  double offset_px;  // along `outwards`
  double contrast;   // paper minus ink
};

// The place where the picture changes from ink to paper within `reach_px` of `middle`: the mean of the position
// weighted with the slope, which for a step seen through any symmetric blur is the step itself. Integration by parts
// makes a derivative unnecessary.
std::optional<Crossing> crossing(const cv::Mat1f& grey, const Eigen::Vector2d& middle, const Eigen::Vector2d& outwards,
                                 double reach_px) {
  constexpr int kSteps = 24;
  const double step = 2.0 * reach_px / kSteps;
  double first = 0.0, last = 0.0, integral = 0.0;
  for (int i = 0; i <= kSteps; ++i) {
    const std::optional<double> value = interpolated(grey, middle + (i * step - reach_px) * outwards);
    if (!value) return std::nullopt;
    if (i == 0) first = *value;
    if (i == kSteps) last = *value;
    integral += *value * step * (i == 0 || i == kSteps ? 0.5 : 1.0);
  }
  if (!(last > first)) return std::nullopt;
  return Crossing{.offset_px = (reach_px * (first + last) - integral) / (last - first), .contrast = last - first};
}

std::optional<Line> edge(const cv::Mat1f& grey, const Eigen::Vector2d& from, const Eigen::Vector2d& to,
                         const Eigen::Vector2d& inside, double reach_px) {
  const double length = (to - from).norm();
  const Eigen::Vector2d along = (to - from) / length;
  Eigen::Vector2d outwards(along.y(), -along.x());
  if (outwards.dot(from - inside) < 0.0) outwards = -outwards;
  std::vector<std::pair<double, Crossing>> found;  // position along the edge, and across
  double strongest = 0.0;
  const int samples = std::max(8, static_cast<int>(length));
  for (int i = 0; i <= samples; ++i) {
    const double position = length * (0.1 + 0.8 * i / samples);  // away from the corners, which are blurred
    if (const auto here = crossing(grey, from + position * along, outwards, reach_px)) {
      found.emplace_back(position, *here);
      strongest = std::max(strongest, here->contrast);
    }
  }
  // The straight line offset = a + b position, by least squares over the places where paper meets ink.
  Eigen::Matrix2d normal = Eigen::Matrix2d::Zero();
  Eigen::Vector2d right = Eigen::Vector2d::Zero();
  int used = 0;
  for (const auto& [position, here] : found) {
    if (here.contrast < 0.5 * strongest || std::abs(here.offset_px) > reach_px) continue;
    const Eigen::Vector2d row(1.0, position / length);
    normal += row * row.transpose();
    right += row * here.offset_px;
    ++used;
  }
  if (used < samples / 2) return std::nullopt;
  const Eigen::Vector2d fit = normal.ldlt().solve(right);
  return Line::Through(from + fit[0] * outwards, to + (fit[0] + fit[1]) * outwards);
}

}  // namespace

std::array<Eigen::Vector2d, 4> refined_corners(const cv::Mat1f& grey,
                                               const std::array<Eigen::Vector2d, 4>& corners_px) {
  constexpr double kLargestMove_px = 1.5, kSmallestCell_px = 3.0;
  std::array<Eigen::Vector2d, 4> corners = corners_px;
  const Eigen::Vector2d inside = 0.25 * (corners[0] + corners[1] + corners[2] + corners[3]);
  for (int pass = 0; pass < 2; ++pass) {  // the second pass is centred on the edge
    std::array<Line, 4> edges;
    for (std::size_t e = 0; e < 4; ++e) {
      // Ink and paper are each one cell wide beside the edge; a cell is an eighth of the neighbouring edges' length.
      const Eigen::Vector2d &from = corners[e], &to = corners[(e + 1) % 4];
      const double across = std::min((corners[(e + 3) % 4] - from).norm(), (corners[(e + 2) % 4] - to).norm());
      const double cell_px = across / 8.0;
      // Pixel and interpolation blur by 1.5 px to either side: the reach must hold an edge's own blur and keep out that
      // of the code's cells (with 0.7 of a cell of 3 px corners came out 0.05-0.13 px too far outwards).
      const double reach_px = std::min({0.7 * cell_px, cell_px - 1.6, 3.5});
      const auto line = cell_px < kSmallestCell_px ? std::nullopt : edge(grey, from, to, inside, reach_px);
      if (!line) return corners_px;
      edges[e] = *line;
    }
    for (std::size_t c = 0; c < 4; ++c) {
      corners[c] = edges[(c + 3) % 4].intersection(edges[c]);
      if (!((corners[c] - corners_px[c]).norm() < kLargestMove_px)) return corners_px;
    }
  }
  return corners;
}

}  // namespace calibration

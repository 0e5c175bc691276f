#include "station/session/develop/sheet_width.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace station {
namespace {

constexpr int kSamplesAlong = 80;
constexpr double kWindowFraction = 0.9;     // of the window's width that is averaged
constexpr double kSearchFraction = 0.2;     // of the expected width, to either side of an edge
constexpr double kSmallestContrast = 0.25;  // |threads - frame| over the brighter of the two

std::optional<double> grey_at(const cv::Mat3f& picture, const Eigen::Vector2d& pixel) {
  const int column = static_cast<int>(std::floor(pixel.x())), row = static_cast<int>(std::floor(pixel.y()));
  if (column < 0 || row < 0 || column + 1 >= picture.cols || row + 1 >= picture.rows) return std::nullopt;
  const double u = pixel.x() - column, v = pixel.y() - row;
  const auto grey = [&](int r, int c) { return static_cast<double>(cv::sum(picture(r, c))[0]); };
  return (1 - v) * ((1 - u) * grey(row, column) + u * grey(row, column + 1)) +
         v * ((1 - u) * grey(row + 1, column) + u * grey(row + 1, column + 1));
}

// Mean brightness along the threads at height z over the sheet's middle.
std::optional<double> level_at(const cv::Mat3f& picture, const renderer::Camera& camera,
                               const inversion::WrappedSpool& spool, double z_mm) {
  double sum = 0.0;
  for (int i = 0; i < kSamplesAlong; ++i) {
    const double y_mm = spool.window_width_mm * kWindowFraction * ((i + 0.5) / kSamplesAlong - 0.5);
    const Eigen::Vector3d on_sheet(spool.thread_diameter_mm / 2, y_mm, z_mm);
    const auto grey = grey_at(picture, renderer::project(camera, on_sheet));
    if (!grey) return std::nullopt;
    sum += *grey;
  }
  return sum / kSamplesAlong;
}

double mean(const std::vector<double>& values, std::size_t from, std::size_t to) {
  double sum = 0.0;
  for (std::size_t i = from; i < to; ++i) sum += values[i];
  return sum / static_cast<double>(to - from);
}

// The place where the profile, going outwards from well within the sheet, crosses half-way between threads and frame,
// in steps of the profile; -1 when it does not.
double crossing(const std::vector<double>& profile) {
  const std::size_t quarter = profile.size() / 4;
  const double inside = mean(profile, 0, quarter), outside = mean(profile, profile.size() - quarter, profile.size());
  if (std::abs(inside - outside) < kSmallestContrast * std::max(inside, outside)) return -1;
  const double half = (inside + outside) / 2, sign = inside > outside ? 1.0 : -1.0;
  for (std::size_t i = profile.size() - 1; i > 0; --i) {
    const double here = sign * (profile[i] - half), before = sign * (profile[i - 1] - half);
    if (here < 0 && before >= 0) return static_cast<double>(i - 1) + before / (before - here);
  }
  return -1;
}

std::optional<double> edge_mm(const cv::Mat3f& picture, const renderer::Camera& camera,
                              const inversion::WrappedSpool& spool, double side) {
  constexpr int kSteps = 200;
  const double width_mm = spool.turns * spool.thread_diameter_mm;
  const double first_mm = width_mm * (0.5 - kSearchFraction), step_mm = 2 * kSearchFraction * width_mm / kSteps;
  std::vector<double> profile;
  for (int i = 0; i <= kSteps; ++i) {
    const auto level = level_at(picture, camera, spool, side * (first_mm + i * step_mm));
    if (!level) return std::nullopt;
    profile.push_back(*level);
  }
  const double at = crossing(profile);
  if (at < 0) return std::nullopt;
  return first_mm + at * step_mm;
}

}  // namespace

std::optional<double> sheet_width_mm(const cv::Mat3f& picture, const renderer::Camera& camera,
                                     const inversion::WrappedSpool& spool) {
  const auto top = edge_mm(picture, camera, spool, 1.0), bottom = edge_mm(picture, camera, spool, -1.0);
  if (!top || !bottom) return std::nullopt;
  return *top + *bottom;
}

}  // namespace station

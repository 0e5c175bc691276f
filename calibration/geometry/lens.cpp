#include "calibration/geometry/lens.h"

#include <opencv2/calib3d.hpp>

namespace calibration {

Lens plain_lens(double focal_length_px, int width_px, int height_px) {
  return {width_px, height_px, focal_length_px, focal_length_px, 0.5 * (width_px - 1), 0.5 * (height_px - 1), {}};
}

std::vector<Eigen::Vector2d> undistort_points(const Lens& lens, const std::vector<Eigen::Vector2d>& pixels) {
  if (pixels.empty()) return {};
  const cv::Matx33d matrix(lens.fx_px, 0, lens.cx_px, 0, lens.fy_px, lens.cy_px, 0, 0, 1);
  std::vector<cv::Point2d> seen, straight;
  for (const Eigen::Vector2d& pixel : pixels) seen.emplace_back(pixel.x(), pixel.y());
  const cv::TermCriteria until(cv::TermCriteria::COUNT | cv::TermCriteria::EPS, 50, 1e-12);
  cv::undistortPoints(seen, straight, matrix, std::vector<double>(lens.distortion.begin(), lens.distortion.end()),
                      cv::noArray(), matrix, until);
  std::vector<Eigen::Vector2d> out;
  for (const cv::Point2d& pixel : straight) out.emplace_back(pixel.x, pixel.y);
  return out;
}

}  // namespace calibration

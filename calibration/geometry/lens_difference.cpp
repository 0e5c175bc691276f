#include "calibration/geometry/lens_difference.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "calibration/sensor/median.h"

namespace calibration {

std::vector<Eigen::Vector2d> picture_grid(const cv::Size& image_size) {
  std::vector<Eigen::Vector2d> grid;
  for (int row = 0; row < kGridRows; ++row)
    for (int column = 0; column < kGridColumns; ++column)
      grid.emplace_back((image_size.width - 1.0) * column / (kGridColumns - 1),
                        (image_size.height - 1.0) * row / (kGridRows - 1));
  return grid;
}

namespace {

// The motion of camera b against camera a under which both see the points along the same rays, by least squares of
// angles. (Least squares of the points themselves would hold the distance fixed, which a slightly longer lens sees as
// slightly larger.) In a narrow picture turns and shifts do nearly the same, so shifts are held to a percent or two of
// the distance.
Eigen::Isometry3d motion_between(const Eigen::Matrix3Xd& points, const Eigen::Matrix3Xd& rays, double distance_mm) {
  constexpr double kShift = 0.02, kAngle_rad = 1e-4;
  Eigen::Isometry3d b_from_a = Eigen::Isometry3d::Identity();
  for (int round = 0; round < 10; ++round) {
    Eigen::Matrix<double, 6, 6> normal = Eigen::Matrix<double, 6, 6>::Zero();
    Eigen::Matrix<double, 6, 1> right = Eigen::Matrix<double, 6, 1>::Zero();
    for (Eigen::Index i = 0; i < points.cols(); ++i) {
      if (!is_inner(static_cast<std::size_t>(i))) continue;
      const Eigen::Vector3d moved = b_from_a * points.col(i) / distance_mm;
      const Eigen::Vector3d direction = moved.normalized();
      const Eigen::Matrix3d across = (Eigen::Matrix3d::Identity() - direction * direction.transpose()) / moved.norm();
      Eigen::Matrix<double, 3, 6> slope;  // derivative by a small turn about the axes and a shift in distances
      for (int axis = 0; axis < 3; ++axis) slope.col(axis) = across * Eigen::Vector3d::Unit(axis).cross(moved);
      slope.rightCols<3>() = across;
      normal += slope.transpose() * slope;
      right += slope.transpose() * (rays.col(i) - direction);
    }
    const double pull = std::pow(kAngle_rad / kShift, 2);
    normal.diagonal().tail<3>().array() += pull;
    right.tail<3>() -= pull * b_from_a.translation() / distance_mm;
    const Eigen::Matrix<double, 6, 1> step = normal.ldlt().solve(right);
    Eigen::Isometry3d by = Eigen::Isometry3d::Identity();
    if (const double angle = step.head<3>().norm(); angle > 0.0)
      by.rotate(Eigen::AngleAxisd(angle, step.head<3>() / angle));
    b_from_a = by * b_from_a;
    b_from_a.translation() += distance_mm * step.tail<3>();
    if (step.norm() < 1e-12) break;
  }
  return b_from_a;
}

}  // namespace

std::vector<double> projection_differences(const ModelledLens& a, const ModelledLens& b, double distance_mm) {
  const std::vector<Eigen::Vector2d> grid = picture_grid(a.image_size);
  Eigen::Matrix3Xd points(3, static_cast<Eigen::Index>(grid.size())), rays = points;
  for (std::size_t i = 0; i < grid.size(); ++i) {
    points.col(static_cast<Eigen::Index>(i)) = distance_mm * ray_of(a, grid[i]);
    rays.col(static_cast<Eigen::Index>(i)) = ray_of(b, grid[i]);
  }
  const Eigen::Isometry3d b_from_a = motion_between(points, rays, distance_mm);
  std::vector<double> differences;
  for (std::size_t i = 0; i < grid.size(); ++i) {
    const Eigen::Vector3d point = b_from_a * points.col(static_cast<Eigen::Index>(i));
    differences.push_back((project_with(b, point) - grid[i]).norm());
  }
  return differences;
}

bool is_inner(std::size_t i) {
  const auto row = static_cast<int>(i) / kGridColumns, column = static_cast<int>(i) % kGridColumns;
  return 6 * row >= kGridRows - 1 && 6 * row <= 5 * (kGridRows - 1) && 6 * column >= kGridColumns - 1 &&
         6 * column <= 5 * (kGridColumns - 1);
}

LensDifference summary(const std::vector<double>& differences_px) {
  std::vector<double> inner;
  for (std::size_t i = 0; i < differences_px.size(); ++i)
    if (is_inner(i)) inner.push_back(differences_px[i]);
  if (inner.empty()) return {};
  LensDifference out;
  for (const double d : inner) out.rms_px += d * d / static_cast<double>(inner.size());
  out.rms_px = std::sqrt(out.rms_px);
  out.median_px = median(inner);
  out.largest_px = std::ranges::max(inner);
  return out;
}

}  // namespace calibration

#include <cmath>
#include <vector>

#include "calibration/geometry/correspondences.h"
#include "calibration/geometry/platform.h"
#include "calibration/geometry/pose.h"
#include "calibration/geometry/projection.h"

namespace calibration {

std::optional<AngleFit> measure_angle(const Lens& lens, const PlatformFit& platform, const TagLayout& ring,
                                      const TagObservation& seen) {
  const std::vector<Corner> corners = match_corners(ring, seen);
  if (corners.empty()) return std::nullopt;
  const std::optional<PoseFit> pose = fit_pose(lens, ring, seen);
  if (!pose) return std::nullopt;
  const Intrinsics intrinsics = intrinsics_of(lens);
  const Eigen::Isometry3d camera_from_world = platform.world_from_camera.inverse();
  const Eigen::Matrix3d turned =
      (platform.world_from_camera * pose->camera_from_object).linear() * platform.world_from_ring.linear().transpose();
  double angle_rad = std::atan2(turned(1, 0) - turned(0, 1), turned(0, 0) + turned(1, 1));
  double squares = 0.0, slopes = 0.0;
  constexpr int kSteps = 6;  // enough Gauss-Newton steps from a pose good to a degree
  for (int step = 0; step < kSteps; ++step) {
    double gradient = 0.0;
    squares = slopes = 0.0;
    for (const Corner& corner : corners) {
      const auto error = [&](double at_rad) -> Eigen::Vector2d {
        const Eigen::AngleAxisd turn(at_rad, Eigen::Vector3d::UnitZ());
        const Eigen::Vector3d in_camera = camera_from_world * (turn * (platform.world_from_ring * corner.point));
        return project(intrinsics.data(), in_camera) - corner.pixel;
      };
      constexpr double kStep_rad = 1e-5;
      const Eigen::Vector2d r = error(angle_rad);
      const Eigen::Vector2d slope = (error(angle_rad + kStep_rad) - error(angle_rad - kStep_rad)) / (2.0 * kStep_rad);
      gradient += slope.dot(r);
      slopes += slope.squaredNorm();
      squares += r.squaredNorm();
    }
    angle_rad -= gradient / slopes;
  }
  const double residuals = 2.0 * static_cast<double>(corners.size());
  return AngleFit{.angle_rad = angle_rad,
                  .sigma_rad = std::sqrt(squares / (residuals - 1.0) / slopes),
                  .rms_px = std::sqrt(squares / residuals),
                  .tags_used = static_cast<int>(corners.size() / 4)};
}

}  // namespace calibration

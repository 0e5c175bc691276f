#include "calibration/geometry/board_plan.h"

#include <cmath>

#include "calibration/geometry/projection.h"
#include "calibration/geometry/target_stand.h"
#include "calibration/sensor/degree.h"

namespace calibration {
namespace {

using Eigen::Isometry3d, Eigen::Vector3d;

constexpr double kTurnStep = 1 * kDegree;
constexpr double kSteepest = 55 * kDegree;  // from the board's normal to the camera
constexpr double kMargin = 0.03;            // of the picture's width, at its border

bool shows(const RoughCamera& camera, const TagLayout& board, const Isometry3d& world_from_board) {
  const Vector3d to_camera = (camera.world_from_camera.translation() - world_from_board.translation()).normalized();
  return world_from_board.linear().col(2).dot(to_camera) > std::cos(kSteepest) &&
         2 * tags_in_picture(camera, board, world_from_board) >= static_cast<int>(board.tags.size());
}

}  // namespace

bool in_picture(const RoughCamera& camera, const Vector3d& world) {
  const double margin = kMargin * camera.lens.width_px;
  const Point<double> point = camera.world_from_camera.inverse() * world;
  if (point.z() <= 0) return false;
  const Intrinsics intrinsics = intrinsics_of(camera.lens);
  const Eigen::Vector2d pixel = project(intrinsics.data(), point);
  return pixel.x() > margin && pixel.y() > margin && pixel.x() < camera.lens.width_px - margin &&
         pixel.y() < camera.lens.height_px - margin;
}

int tags_in_picture(const RoughCamera& camera, const TagLayout& layout, const Isometry3d& world_from_object) {
  int count = 0;
  for (const Tag& tag : layout.tags) {
    bool whole = true;
    for (const Vector3d& corner : corners_in_object(tag))
      whole = whole && in_picture(camera, world_from_object * corner);
    count += whole;
  }
  return count;
}

std::vector<double> plan_board_angles(const RoughCamera& camera, const TagLayout& board,
                                      const Isometry3d& platform_from_board, int count, double limit_rad) {
  std::vector<double> shown;
  const int steps = static_cast<int>(limit_rad / kTurnStep + 1e-9);
  for (int step = -steps; step <= steps; ++step) {
    const double angle = step * kTurnStep;
    if (shows(camera, board, turned(angle, platform_from_board))) shown.push_back(angle);
  }
  if (static_cast<int>(shown.size()) <= count) return shown;
  std::vector<double> angles;
  const double middle = 0.5 * (static_cast<double>(shown.size()) - 1);
  for (int i = 0; i < count; ++i) {
    const double u = count > 1 ? 2.0 * i / (count - 1) - 1 : 0;  // -1 to 1
    angles.push_back(
        shown[static_cast<std::size_t>(std::lround(middle * (1 + std::copysign(std::sqrt(std::abs(u)), u))))]);
  }
  return angles;
}

}  // namespace calibration

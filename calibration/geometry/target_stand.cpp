#include "calibration/geometry/target_stand.h"

#include <cmath>

namespace calibration {

double ledge_mm(double lean_rad, double panel_mm) {
  return panel_mm / 2 * std::sin(lean_rad);
}

Eigen::Isometry3d on_stand(double lean_rad, double plate_mm, double panel_mm, double platform_mm) {
  const Eigen::Vector3d up(-std::sin(lean_rad), 0, std::cos(lean_rad)), out(std::cos(lean_rad), 0, std::sin(lean_rad));
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.linear() << up.cross(out), up, out;
  pose.translation() =
      Eigen::Vector3d(ledge_mm(lean_rad, panel_mm), 0, platform_mm + kLedgeHeight_mm) + plate_mm / 2 * up;
  return pose;
}

Eigen::Isometry3d turned(double angle_rad, const Eigen::Isometry3d& platform_from_object) {
  return Eigen::AngleAxisd(angle_rad, Eigen::Vector3d::UnitZ()) * platform_from_object;
}

}  // namespace calibration

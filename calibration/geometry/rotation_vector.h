// A rotation as its axis times its angle (rad).
#pragma once

#include <Eigen/Geometry>

namespace calibration {

inline Eigen::Vector3d rotation_vector(const Eigen::Matrix3d& rotation) {
  const Eigen::AngleAxisd turn(rotation);
  return turn.angle() * turn.axis();
}

}  // namespace calibration

// The angles to which a platform turns a board that stands on it, for pictures of the lens's calibration.
#pragma once

#include <Eigen/Geometry>
#include <vector>

#include "calibration/geometry/lens.h"
#include "calibration/geometry/tags.h"

namespace calibration {

// About how the camera sees the platform: `lens` by its engraving, the pose by tape.
struct RoughCamera {
  Lens lens;
  Eigen::Isometry3d world_from_camera = Eigen::Isometry3d::Identity();
};

// Whether a point (world, mm) lies in the picture, away from its border.
bool in_picture(const RoughCamera& camera, const Eigen::Vector3d& world);

// How many of the object's tags lie wholly in the picture.
int tags_in_picture(const RoughCamera& camera, const TagLayout& layout, const Eigen::Isometry3d& world_from_object);

// At most `count` angles in rising order, of those within `limit_rad` at which the board's face is within 55 degrees of
// the camera and half of its tags are in the picture; none when there is no such angle. They are denser towards both
// ends, because what a picture tells of focal length and centre grows with the board's tilt.
// platform_from_board: platform frame at angle 0 = world.
std::vector<double> plan_board_angles(const RoughCamera& camera, const TagLayout& board,
                                      const Eigen::Isometry3d& platform_from_board, int count, double limit_rad);

}  // namespace calibration

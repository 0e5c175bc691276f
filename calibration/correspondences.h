// Seen tag corners matched with the corners of a layout: what every geometric fit starts from.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "calibration/tags.h"

namespace calibration {

struct Corner {
  Eigen::Vector3d point;  // object frame, mm
  Eigen::Vector2d pixel;
};

// Four corners for each seen tag that the layout has; other ids are left out. Throws std::runtime_error when a
// position is not a finite number.
std::vector<Corner> match_corners(const TagLayout& layout, const TagObservation& seen);

}  // namespace calibration

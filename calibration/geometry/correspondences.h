// Pairs of a tag corner in a layout and its position in a picture, from which every geometric fit starts.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "calibration/geometry/tags.h"

namespace calibration {

struct Corner {
  Eigen::Vector3d point;  // object frame, mm
  Eigen::Vector2d pixel;
};

// The four corners of each seen tag that the layout has; other ids are left out. Throws std::runtime_error when a
// position is not a finite number.
std::vector<Corner> match_corners(const TagLayout& layout, const TagObservation& seen);

}  // namespace calibration

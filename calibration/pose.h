// Pose of a tagged object in front of a calibrated camera.
#pragma once

#include <Eigen/Geometry>
#include <optional>

#include "calibration/lens.h"
#include "calibration/tags.h"

namespace calibration {

struct PoseFit {
  Eigen::Isometry3d camera_from_object = Eigen::Isometry3d::Identity();
  double rms_px = 0.0;  // per axis
  int tags_used = 0;
  Eigen::Matrix<double, 6, 6> covariance;  // rotation vector (rad) then translation (mm), for `sigma_px` = rms
};

// std::nullopt when no tag of the layout was seen.
std::optional<PoseFit> fit_pose(const Lens& lens, const TagLayout& layout, const TagObservation& seen);

}  // namespace calibration

// Pose of a tagged object in front of a calibrated camera.
#pragma once

#include <Eigen/Geometry>
#include <optional>

#include "calibration/correspondences.h"
#include "calibration/lens.h"
#include "calibration/tags.h"

namespace calibration {

struct PoseFit {
  Eigen::Isometry3d camera_from_object = Eigen::Isometry3d::Identity();
  double rms_px = 0.0;  // per axis
  int tags_used = 0;    // corners / 4
  // Of a small rotation (rad) about the camera's axes through the object's origin, then of that origin's position
  // (mm, camera frame), for the corner noise that the residuals show (degrees of freedom taken out).
  Eigen::Matrix<double, 6, 6> covariance = Eigen::Matrix<double, 6, 6>::Zero();
  bool converged = false;
};

// All tags of the layout that were seen, in one least squares fit with a Huber loss at 1 px; of the two poses that a
// flat object allows, the one that fits better. std::nullopt when no tag of the layout was seen. Throws
// std::runtime_error on corners that are not finite numbers.
std::optional<PoseFit> fit_pose(const Lens& lens, const TagLayout& layout, const TagObservation& seen);

// The same for corners that are matched already; std::nullopt for fewer than four.
std::optional<PoseFit> fit_pose(const Lens& lens, const std::vector<Corner>& corners);

}  // namespace calibration

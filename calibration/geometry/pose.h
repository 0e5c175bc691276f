// The fit of a tagged object's pose: in front of a calibrated camera, or on the platform from several of its angles.
#pragma once

#include <Eigen/Geometry>
#include <optional>
#include <vector>

#include "calibration/geometry/correspondences.h"
#include "calibration/geometry/lens.h"
#include "calibration/geometry/tags.h"

namespace calibration {

struct PoseFit {
  Eigen::Isometry3d camera_from_object = Eigen::Isometry3d::Identity();
  double rms_px = 0.0;        // per axis, over the tags used
  int tags_used = 0;          // corners used / 4
  std::vector<int> odd_tags;  // tags left out: more than 2 px (and 6 sigma) from where the others place them
  // Covariance of a small rotation (rad) about the camera's axes through the object's origin, then of that origin's
  // position (mm, camera frame), for the corner noise that the residuals show (degrees of freedom taken out).
  Eigen::Matrix<double, 6, 6> covariance = Eigen::Matrix<double, 6, 6>::Zero();
  bool converged = false;
};

// The pose that fits all tags of the layout that were seen and agree, by least squares with a Huber loss at 1 px; of
// the two poses that a flat object allows, the one that fits better. A tag that was moved, or printed with another's
// id, is found by consensus, as long as three or more tags agree. std::nullopt when no tag of the layout was seen.
// Throws std::runtime_error on corners that are not finite numbers.
std::optional<PoseFit> fit_pose(const Lens& lens, const TagLayout& layout, const TagObservation& seen);

// The same for corners that are matched already; std::nullopt for fewer than four.
std::optional<PoseFit> fit_pose(const Lens& lens, const std::vector<Corner>& corners);

// One picture of an object that keeps its place on the platform, whose own pose is known.
struct Sighting {
  Eigen::Isometry3d camera_from_platform = Eigen::Isometry3d::Identity();
  TagObservation seen;
};

struct MountedFit {
  Eigen::Isometry3d platform_from_object = Eigen::Isometry3d::Identity();
  double rms_px = 0.0;
  int tags_used = 0;  // sum over the sightings
  std::vector<int> odd_tags;
  // As PoseFit's, but about the platform's axes.
  Eigen::Matrix<double, 6, 6> covariance = Eigen::Matrix<double, 6, 6>::Zero();
  bool converged = false;
};

// The pose that fits all sightings at once; std::nullopt when none shows a tag of the layout. One sighting measures the
// place along the line of sight by the tags' size alone; a second one, 70 degrees from it, sees it across the picture
// and measures it some ten times better, and rotations twice as well.
std::optional<MountedFit> fit_mounted_pose(const Lens& lens, const TagLayout& layout,
                                           const std::vector<Sighting>& sightings);

}  // namespace calibration

// The least squares problem of the platform's fit (platform.h): camera, axis, ring, tags on the table, one angle per
// picture.
#pragma once

#include <ceres/ceres.h>

#include <Eigen/Geometry>
#include <array>
#include <map>
#include <vector>

#include "calibration/geometry/correspondences.h"
#include "calibration/geometry/projection.h"

namespace calibration {

struct TaggedCorner {
  int id;
  Corner corner;
  bool used = true;
};

std::vector<TaggedCorner> tagged_corners(const TagLayout& layout, const TagObservation& seen);

// The unknowns. The axis frame is the world frame of platform.h as known so far; each pass of the fit ends by making it
// so again. Gauge: the first angle is 0; the ring keeps its turn about the axis (which the angles and the camera take
// up) and its height (which the table and the camera take up).
struct Bundle {
  Intrinsics intrinsics{};
  Eigen::Isometry3d camera_from_axis = Eigen::Isometry3d::Identity();
  Eigen::Isometry3d axis_from_ring = Eigen::Isometry3d::Identity();   // at angle 0
  Eigen::Isometry3d axis_from_sheet = Eigen::Isometry3d::Identity();  // the tags on the table
  double sheet_height_mm = 0.0;
  std::vector<double> angles_rad;
  std::vector<std::vector<TaggedCorner>> turning, fixed;  // corners on ring and table, by picture

  Motion axis_motion{};                 // motion of the axis frame seen from the camera
  std::array<double, 4> ring_motion{};  // two tilts (rad), x, y (mm)
  Motion sheet_motion{};
};

// The pose of the world frame (calibration/geometry/platform.h) from the axis, a point on it, the table's plane and the
// camera, all in one frame.
Eigen::Isometry3d frame_with_world(const Eigen::Vector3d& axis, const Eigen::Vector3d& on_axis,
                                   const Eigen::Vector3d& table_normal, const Eigen::Vector3d& on_table,
                                   const Eigen::Vector3d& camera);

// Does one pass of least squares over the corners used, with a Huber loss at 1 px, and moves the poses by the motions
// found. False when it did not converge.
bool solve(Bundle& bundle);

// Chooses the corners to use: those beyond 5 sigma are left out (sigma from the median), because the detector sometimes
// misses an edge of a slanting tag by a pixel.
void judge_corners(Bundle& bundle);

// Computes the covariance of the axis's tilts about x and y and of its place in x and y, for errors of 1 px; false when
// the pictures leave a direction undetermined.
bool take_covariance(Bundle& bundle, Eigen::Matrix4d& out);

struct Errors {
  double squares = 0.0, count = 0.0;
  void add(const Eigen::Vector2d& error) {
    squares += error.squaredNorm();
    count += 2.0;
  }
  double rms() const { return count > 0.0 ? std::sqrt(squares / count) : 0.0; }
};

struct AllErrors {
  Errors used;                   // all corners used
  std::vector<Errors> pictures;  // the corners used, by picture
  std::map<int, Errors> tags;    // all corners, by tag
};

AllErrors errors_of(Bundle& bundle);

}  // namespace calibration

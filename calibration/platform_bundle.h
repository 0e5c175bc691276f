// The unknowns of the platform's fit with their residuals: camera, axis, ring, tags on the table, one angle per view.
#pragma once

#include <ceres/ceres.h>

#include <Eigen/Geometry>
#include <array>
#include <map>
#include <vector>

#include "calibration/correspondences.h"
#include "calibration/projection.h"

namespace calibration {

struct TaggedCorner {
  int id;
  Corner corner;
  bool used = true;
};

std::vector<TaggedCorner> tagged_corners(const TagLayout& layout, const TagObservation& seen);

// The unknowns. The axis frame is the world frame of the header, as far as it is known; each pass of the fit ends by
// making it so again. Gauge: the first angle is 0; the ring keeps its turn about the axis (given to the angles and
// the camera) and its height (given to the table and the camera).
struct Bundle {
  Intrinsics intrinsics{};
  Eigen::Isometry3d camera_from_axis = Eigen::Isometry3d::Identity();
  Eigen::Isometry3d axis_from_ring = Eigen::Isometry3d::Identity();   // at angle 0
  Eigen::Isometry3d axis_from_sheet = Eigen::Isometry3d::Identity();  // the tags on the table
  double sheet_height_mm = 0.0;
  std::vector<double> angles_rad;
  std::vector<std::vector<TaggedCorner>> turning, fixed;  // by view

  Motion axis_motion{};                 // of the axis frame seen from the camera
  std::array<double, 4> ring_motion{};  // two tilts (rad), x, y (mm)
  Motion sheet_motion{};
};

// The world frame (calibration/platform.h) from an axis, a point on it, the table's plane and the camera, all in one
// frame.
Eigen::Isometry3d frame_with_world(const Eigen::Vector3d& axis, const Eigen::Vector3d& on_axis,
                                   const Eigen::Vector3d& table_normal, const Eigen::Vector3d& on_table,
                                   const Eigen::Vector3d& camera);

// One pass of least squares over the corners used, with a Huber loss at 1 px; the motions end in the poses. False when
// it did not converge.
bool solve(Bundle& bundle);

// Here and there the detector misses an edge of a slanting tag by a pixel: corners beyond 5 sigma stay out, sigma
// being told by the median.
void judge_corners(Bundle& bundle);

// Tilts of the axis about x and y and its place in x and y, for errors of 1 px; false when the views leave a direction
// undetermined.
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
  Errors used;
  std::vector<Errors> views;   // of the corners used
  std::map<int, Errors> tags;  // of all corners
};

AllErrors errors_of(Bundle& bundle);

}  // namespace calibration

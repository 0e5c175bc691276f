// Rotation axis of the platform and the world frame, from one joint bundle over tagged views (calibration.md 1d).
//
// World: origin = where the axis meets the table plane; +z = axis, up; +x = horizontal projection of the direction to
// the camera centre; right-handed; mm.
#pragma once

#include <Eigen/Geometry>
#include <vector>

#include "calibration/lens.h"
#include "calibration/tags.h"

namespace calibration {

struct PlatformView {
  double reading_rad = 0.0;  // turntable's own reading
  TagObservation seen;       // board standing on the platform, turning with it
};

struct PlatformFit {
  Eigen::Isometry3d world_from_camera = Eigen::Isometry3d::Identity();
  Eigen::Isometry3d world_from_board = Eigen::Isometry3d::Identity();  // of the turning board at angle 0
  std::vector<double>
      angles_rad;  // measured, one per view, counter-clockwise from above, 0 at reading 0 (by the fitted line)
  // Measured angle counted from the first view = scale * reading + offset, least squares; the offset is already taken
  // out of angles_rad. A turntable that counts clockwise has a scale near -1.
  double scale = 1.0, offset_rad = 0.0;
  double angle_rms_rad = 0.0;             // about that line
  double rms_px = 0.0;                    // per axis
  double axis_to_table_normal_rad = 0.0;  // the axis against the table's normal
  // Tilts of the axis about the world's x and y (rad), then where it meets the table along x and y (mm), relative to
  // the camera, for the corner noise that the residuals show.
  Eigen::Matrix<double, 4, 4> axis_covariance = Eigen::Matrix<double, 4, 4>::Zero();
  bool converged = false;
};

// `table_views`: the same board lying flat on the table (its plane is the table's, `board_thickness_mm` above it),
// facing up. Each angle is a free unknown: nothing is believed of the turntable. Throws std::runtime_error when fewer
// than three turning views or no table view were given, a view does not show the board, or the views do not turn by
// 20 degrees.
PlatformFit fit_platform(const Lens& lens, const TagLayout& board, const std::vector<PlatformView>& turning,
                         const std::vector<TagObservation>& table_views, double board_thickness_mm);

}  // namespace calibration

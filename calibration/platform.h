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
  std::vector<double> angles_rad;        // measured, one per view, 0 at reading 0 (by the fitted line)
  double scale = 1.0, offset_rad = 0.0;  // measured angle = scale * reading + offset, least squares
  double angle_rms_rad = 0.0;            // about that line
  double rms_px = 0.0;                   // per axis
  Eigen::Matrix<double, 4, 4>
      axis_covariance;  // direction tilts about camera-facing axes x, y (rad), position across in x, y (mm)
  bool converged = false;
};

// `table_views`: the same board lying flat on the table (its plane is the table's, `board_thickness_mm` above it).
PlatformFit fit_platform(const Lens& lens, const TagLayout& board, const std::vector<PlatformView>& turning,
                         const std::vector<TagObservation>& table_views, double board_thickness_mm);

}  // namespace calibration

// The fit of the platform's rotation axis and the world frame: one joint bundle over pictures that show tags.
//
// World: origin = where the axis meets the table plane; +z = axis, up; +x = horizontal projection of the direction to
// the camera centre; right-handed; mm.
#pragma once

#include <Eigen/Geometry>
#include <optional>
#include <vector>

#include "calibration/geometry/lens.h"
#include "calibration/geometry/tags.h"
#include "calibration/sensor/gate.h"

namespace calibration {

struct PlatformTargets {
  TagLayout ring;                // turns with the platform; +z up
  TagLayout table;               // lies on the table beside the platform; +z up
  double table_height_mm = 0.0;  // height of that sheet's printed face above the table: the sheet's thickness
};

struct PlatformPicture {
  double reading_rad = 0.0;  // the turntable's own reading
  TagObservation seen;       // all tags in the picture
};

struct PlatformFit {
  Eigen::Isometry3d world_from_camera = Eigen::Isometry3d::Identity();
  Eigen::Isometry3d world_from_ring = Eigen::Isometry3d::Identity();  // at angle 0
  Eigen::Isometry3d world_from_table = Eigen::Isometry3d::Identity();
  // Measured angles, one per picture, counter-clockwise from above, 0 at reading 0 (by the fitted line).
  std::vector<double> angles_rad;
  std::vector<double> readings_rad;  // as given, one per picture
  // The fitted line: angle counted from the first picture = scale * reading + offset, least squares; the offset is
  // already taken out of angles_rad. A turntable that counts clockwise has a scale near -1.
  double scale = 1.0, offset_rad = 0.0;
  double angle_rms_rad = 0.0;             // scatter of the angles about that line
  double rms_px = 0.0;                    // corner residuals, per axis
  std::vector<double> picture_rms_px;     // the same, one per picture
  double axis_to_table_normal_rad = 0.0;  // angle between the axis and the table's normal
  // Covariance of the axis's tilts about the world's x and y (rad), then of the place where it meets the table along x
  // and y (mm), relative to the camera, for the corner noise that the residuals show and an exact lens.
  Eigen::Matrix<double, 4, 4> axis_covariance = Eigen::Matrix<double, 4, 4>::Zero();
  std::vector<Gate> gates;
  bool converged = false;
};

// Fits axis, angles and targets to the pictures. Each angle is a free unknown, so the turntable's readings are not
// trusted. Throws std::runtime_error when fewer than three pictures were given, the ring is missing in one, no picture
// shows two of the table's tags, the pictures do not turn by 20 degrees, or a tag contradicts the others (the message
// names the tag).
PlatformFit fit_platform(const Lens& lens, const PlatformTargets& targets,
                         const std::vector<PlatformPicture>& pictures);

struct AngleFit {
  double angle_rad = 0.0;  // the platform's angle, within +-pi
  double sigma_rad = 0.0;  // its standard error for the corner noise that the residuals show
  double rms_px = 0.0;     // per axis
  int tags_used = 0;
};

// The platform's angle in a picture, from the ring's tags alone; std::nullopt when no tag of the ring was seen.
std::optional<AngleFit> measure_angle(const Lens& lens, const PlatformFit& platform, const TagLayout& ring,
                                      const TagObservation& seen);

}  // namespace calibration

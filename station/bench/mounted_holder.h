// Where the holder stands on the platform, from the pose pictures of a mounting.
#pragma once

#include <Eigen/Geometry>
#include <string>
#include <vector>

#include "calibration/geometry/tags.h"
#include "station/documents/calibration_file.h"
#include "station/documents/rig_file.h"

namespace station {

struct PosePicture {
  std::string step;
  double reading_rad = 0.0;  // of the turntable
  calibration::TagObservation seen;
};

struct MountedHolder {
  Eigen::Isometry3d platform_from_holder = Eigen::Isometry3d::Identity();
  double rms_px = 0.0;
};

inline constexpr long kFewestHolderTags = 2;
// How many of the holder's tags are in the picture.
long tags_of_holder(const PosePicture& picture, const calibration::TagLayout& holder);

// Whether enough of the holder's tags are in the picture for measure_holder.
bool shows_holder(const PosePicture& picture, const calibration::TagLayout& holder);

// The holder's place, from all pictures at once. Throws std::runtime_error when fewer than two of the holder's tags are
// seen in a picture, a tag is out of place, or the bench does not stand as it was calibrated.
MountedHolder measure_holder(const std::vector<PosePicture>& pictures, const RigCalibration& calibration,
                             const RigFile& rig);

}  // namespace station

// Where the holder stands on the platform: nominally, and as the pose pictures of a mounting show it.
#pragma once

#include <Eigen/Geometry>
#include <string>
#include <vector>

#include "calibration/geometry/tags.h"
#include "station/documents/calibration_file.h"
#include "station/documents/rig_file.h"
#include "station/documents/spool.h"

namespace station {

// The nominal pose of the holder in the world frame at platform angle 0: upright on the platform, its front over the
// axis; turned a quarter for vertical threads.
Eigen::Isometry3d nominal_holder_pose(const RigFile& rig, const inversion::WrappedSpool& spool, rig::Mounting mounting);
// The nominal pose of what is photographed: the holder's, or that of a cylinder, which stands upright in the middle of
// the platform.
Eigen::Isometry3d nominal_pose(const RigFile& rig, const Spool& spool, rig::Mounting mounting);

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

// What a picture of a session must show before it is kept, so that the person hears of it while the spool still stands there.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>

#include "station/capture/plan.h"
#include "station/capture/session_folder.h"
#include "station/documents/calibration_file.h"
#include "station/documents/session_file.h"

namespace station {

// Throws std::runtime_error with one line (what was asked, found, what to do):
//   views  over-exposed (5 % of the window saturated) or dark (the brightest threads below 2 % of the range);
//          the reference patch says that the lamp is off or covered (below half of its light), that other light shines or the
//          lamp has changed (more than 10 % from the calibration), or that it jumped (more than 2 % since this run's last view
//          under the same lamp and mounting; after a resume the first view is accepted: the person has seen to it)
//   darks  brighter than the calibration's dark level by 0.1 % of the range
// Without a rig's reference patch, or before its mounting's pose picture shows two tags, the patch is not looked at.
using InspectPicture = std::function<void(const PlanStep&, const rig::Picture&, double platform_reading_rad)>;
InspectPicture make_inspection(const SessionFolder& session, const SessionFile& asked,
                               const RigCalibration& calibration);

// 255 over the holder's window (where it should stand), where threads are metered; raw pixels.
cv::Mat1b window_region(const RigFile& rig, const inversion::WrappedSpool& spool, const RigCalibration& calibration,
                        rig::Mounting mounting, double platform_angle_rad);

// Where the holder should stand: upright on the platform, its front over the axis; turned a quarter for vertical threads.
Eigen::Isometry3d nominal_holder_pose(const RigFile& rig, const inversion::WrappedSpool& spool,
                                      rig::Mounting mounting);

}  // namespace station

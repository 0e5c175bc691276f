// What a picture of a session must show before it is kept, so that the person hears of it while the spool still stands
// there.
#pragma once

#include <memory>

#include "station/capture/metering.h"
#include "station/capture/plan.h"
#include "station/capture/session_folder.h"
#include "station/capture/verdict.h"
#include "station/documents/calibration_file.h"
#include "station/documents/session_file.h"

namespace station {

// Chooses exposures and judges pictures of one run. Findings (verdict.h) with their values' units and limits:
//   settings     stops between what the file says and the camera said; a sixth of a stop
//   stale        the file is older than one that came before; may pass again
//   bench        px that the table's tags moved since the calibration; what 0.1 mm is there
//   angle        degrees from the turntable's reading to what the ring's tags say; 0.5
//   motion       px between the last test picture and this one, by their tags; 0.2; may pass again
//   orientation  degrees of the holder from its nominal pose; 30 (pose pictures)
//   tags         how many were seen; of the holder's in a pose picture: 2, doubtful below
//   focus        pose pictures: px that printed edges are soft, doubtful above 2, bad above 3; views: detail of the threads
//                (picture_measures.h), doubtful below 60 %, bad below 40 % of the median of three or more views before it
//                under the same lamp and mounting
//   saturation   % of the window; doubtful above 0.5, bad above 5
//   exposure     % of the range that the brightest threads reach; 2
//   shadows      % of the range that a tenth of the window stays below; never bad
//   lamp, lamp_side   lamp_checks.h
//   dark         % of the range above the calibration's dark level; 0.1
// What cannot be looked at (no tags in the picture, no patch on the rig, a mounting whose pose picture shows fewer than two
// tags) has no finding.
class CaptureChecks {
 public:
  // The first three must outlive the checks. `in_order`: a file that is older than the one before it is stale.
  CaptureChecks(const SessionFolder& session, const SessionFile& asked, const RigCalibration& calibration,
                bool in_order = true);

  // Errors: std::runtime_error for a test picture that cannot be read, or of another camera; while the holder can still be
  // put right, for a bench that does not stand as it was calibrated.
  ExposureChoice choose_exposure(const PlanStep& step, const rig::Picture& test);
  // Strength of the lamp at the reference patch, 1 = as calibrated; nothing where there is no patch, it cannot be read or the
  // lamp is off. Errors: std::runtime_error for a picture that cannot be read.
  std::optional<double> read_lamp(const PlanStep& step, const rig::Picture& test);
  // Errors: std::runtime_error for a picture that cannot be read, or of another camera.
  Verdict judge(const PlanStep& step, const rig::Picture& picture, double platform_reading_rad);

 private:
  class Work;
  std::shared_ptr<Work> work_;  // shared: the runner's options copy what they call
};

// 255 over the holder's window, or the lit side of a cylinder with cloth (where it should stand): what is metered; raw pixels.
cv::Mat1b metered_region(const SessionFile& asked, const RigCalibration& calibration, const PlanStep& step);

// Where the holder should stand: upright on the platform, its front over the axis; turned a quarter for vertical threads.
Eigen::Isometry3d nominal_holder_pose(const RigFile& rig, const inversion::WrappedSpool& spool,
                                      rig::Mounting mounting);
// The same of whatever is photographed: a cylinder stands upright in the middle of the platform.
Eigen::Isometry3d nominal_pose(const RigFile& rig, const Spool& spool, rig::Mounting mounting);

}  // namespace station

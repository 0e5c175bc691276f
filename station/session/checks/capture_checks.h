// The checks that a picture of a session must pass before it is kept, made while the spool still stands there, so that
// the person can act on them.
#pragma once

#include <memory>

#include "station/bench/metering.h"
#include "station/documents/calibration_file.h"
#include "station/documents/plan.h"
#include "station/documents/session_file.h"
#include "station/session/record/session_folder.h"
#include "station/session/record/verdict.h"

namespace station {

// Chooses exposures and judges pictures of one run. The findings (verdict.h), with the units of their values and
// limits:
//   settings     stops between the exposure in the file and the camera's answer; limit a sixth of a stop
//   stale        no value; bad when the file is older than the one before it; may pass again
//   bench        px by which the table's tags moved since the calibration; limit what 0.1 mm is there
//   angle        degrees from the turntable's reading to the angle that the ring's tags show; limit 0.5
//   motion       px between the last test picture and this one, by their tags; limit 0.2; may pass again
//   orientation  degrees of the holder from its nominal pose, in pose pictures; limit 30
//   tags         number of tags seen; in pose pictures the holder's, doubtful below 2
//   focus        pose pictures: px of blur of printed edges, doubtful above 2, bad above 3; views: detail of the
//                threads (sharpness(), picture_measures.h), doubtful below 60 %, bad below 40 % of the median of three
//                or more earlier views under the same lamp and mounting; good down to 15 %, and never bad, where the
//                edges of printed tags are as sharp as in those
//   saturation   % of the window's pixels; doubtful above 0.5, bad above 5
//   exposure     % of the range that the brightest threads reach; bad below 2
//   shadows      % of the range below which a tenth of the window lies; never bad
//   lamp, lamp_side   lamp_checks.h
//   dark         % of the range above the calibration's dark level; limit 0.1
// A check gives no finding when the picture lacks what it needs (no tags in the picture, no reference chip on the rig,
// a mounting whose pose picture shows fewer than two tags).
class CaptureChecks {
 public:
  // `session` and `asked` must outlive the checks. `in_order`: a file that is older than the one before it is stale.
  CaptureChecks(const SessionFolder& session, const SessionFile& asked, const RigCalibration& calibration,
                bool in_order = true);

  // Chooses the next exposure after a test picture. Errors: std::runtime_error for a test picture that cannot be read
  // or is of another camera; at a pose step, while the holder can still be put right, also for a bench that does not
  // stand as it was calibrated.
  ExposureChoice choose_exposure(const PlanStep& step, const rig::Picture& test);
  // The strength of the lamp at the reference chip, 1 = as calibrated; nothing where there is no chip, it cannot be
  // read or the lamp is off. Errors: std::runtime_error for a picture that cannot be read.
  std::optional<double> read_lamp(const PlanStep& step, const rig::Picture& test);
  // Makes all checks of a picture. Errors: std::runtime_error for a picture that cannot be read or is of another
  // camera.
  Verdict judge(const PlanStep& step, const rig::Picture& picture, double platform_reading_rad);

 private:
  class Work;
  std::shared_ptr<Work> work_;  // shared: the runner's options copy what they call
};

// The region of the raw picture that is metered, 255 inside: where the holder's window should stand, or the lit side of
// a cylinder with cloth.
cv::Mat1b metered_region(const SessionFile& asked, const RigCalibration& calibration, const PlanStep& step);

}  // namespace station

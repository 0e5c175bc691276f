// Whether a view was lit as it should be: by the calibrated lamp, from the side that its step asks for.
#pragma once

#include <Eigen/Geometry>
#include <functional>
#include <optional>
#include <vector>

#include "calibration/develop.h"
#include "inversion/view.h"
#include "renderer/camera.h"
#include "station/capture/plan.h"
#include "station/capture/verdict.h"
#include "station/documents/calibration_file.h"
#include "station/documents/session_file.h"

namespace station {

// A part of the picture that is looked at, developed: large pictures are dear, and little of them is asked for.
using DevelopPart = std::function<calibration::Developed(const cv::Rect& part)>;

// Findings:
//   lamp         % of the calibrated lamp at the reference patch: below 50 it is off or covered, 10 from the calibration other
//                light shines or it has changed, 2 from this run's last view under the same lamp and mounting it jumped (after
//                a resume the first view is accepted: the person has seen to it)
//   lamp_side    % of the light of the lamp in front that the holder's tags show; 4: the lamp is on the other side. Tags
//                that are saturated show at least what was read: where that is less than the limit, nothing is known
class LampChecks {
 public:
  // Both must outlive the checks.
  LampChecks(const SessionFile& asked, const RigCalibration& calibration);

  // `camera`: of the whole picture, in the holder's frame, as it is developed for. Nothing about what cannot be looked at.
  std::vector<Finding> judge(const PlanStep& step, const DevelopPart& develop, const renderer::Camera& camera,
                             const Eigen::Isometry3d& holder_from_world);

  // Measured / calibrated strength; nothing where there is no patch, it cannot be read or the lamp is off.
  std::optional<double> read(const PlanStep& step, const DevelopPart& develop, const renderer::Camera& camera,
                             const Eigen::Isometry3d& holder_from_world) const;

 private:
  struct LastView {
    rig::Lamp lamp;
    rig::Mounting mounting;
    double strength;
  };
  std::optional<double> strength(const PlanStep& step, const DevelopPart& develop, const renderer::Camera& camera,
                                 const Eigen::Isometry3d& holder_from_world) const;
  std::string problem(const PlanStep& step, double strength) const;
  std::optional<Finding> side(const PlanStep& step, const DevelopPart& develop, const renderer::Camera& camera,
                              const Eigen::Isometry3d& holder_from_world) const;
  inversion::NearLight lamp(rig::Lamp side, const Eigen::Isometry3d& holder_from_world) const;

  const SessionFile& asked_;
  const RigCalibration& calibration_;
  std::optional<LastView> last_;  // of this run
};

}  // namespace station

// The checks of whether a view was lit as it should be: by the calibrated lamp, from the side that its step asks for.
#pragma once

#include <Eigen/Geometry>
#include <functional>
#include <optional>
#include <vector>

#include "calibration/develop/develop.h"
#include "inversion/view/view.h"
#include "renderer/picture/camera.h"
#include "station/documents/calibration_file.h"
#include "station/documents/plan.h"
#include "station/documents/session_file.h"
#include "station/session/record/verdict.h"

namespace station {

// Develops one part of the picture; large pictures take long to develop whole, and the checks need little of them.
using DevelopPart = std::function<calibration::Developed(const cv::Rect& part)>;

// Judges the lamp in the views of one run. Findings:
//   lamp         % of the calibrated lamp's light at the reference chip. Bad below 50 (the lamp is off or covered),
//                more than 10 away from 100 (other light shines, or the lamp changed), and more than 2 away from this
//                run's last view under the same lamp and mounting (it jumped; the first view after a resume is
//                accepted, because the person has looked after the lamp)
//   lamp_side    % of the light of the lamp in front that the holder's tags show. Above 4 the lamp is taken to stand in
//                front, else behind; bad when the step asks for the other side. Saturated tags show at least what was
//                read: where that is less than the limit, there is no finding
class LampChecks {
 public:
  // `asked` and `calibration` must outlive the checks.
  LampChecks(const SessionFile& asked, const RigCalibration& calibration);

  // The findings on a view; empty where the picture lacks what the checks need. `camera` is that of the whole developed
  // picture, in the holder's frame.
  std::vector<Finding> judge(const PlanStep& step, const DevelopPart& develop, const renderer::Camera& camera,
                             const Eigen::Isometry3d& holder_from_world);

  // The lamp's strength, measured / calibrated; nothing where there is no chip, it cannot be read or the lamp is off.
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
  std::optional<LastView> last_;  // the last good view of this run
};

}  // namespace station

// Executes a capture plan on a rig, one durable record after the other, so that it may end at any instant and go on.
//
// Journal events, in this order for a step (picture_record.h has the picture's data):
//   start   {"plan_sha256", "files": {path: sha256}}; resume {"plan_sha256"} in later runs
//   camera  {"make", "model", "serial", "width_px", "height_px"}
//   arranged {"step", "mounting", "lamp", "room_light"}     the operator has made the arrangement
//   metering {"step", "exposure_s", "test_pictures", "converged"}; warning {"step", "message"}
//   picture  the file is on the disk under its final name
//   discarded {"file", "reason"}                            before the file is removed
//   stop    {"outcome": "complete" | "interrupted" | "failed", "message" (failed only)}
#pragma once

#include <Eigen/Geometry>
#include <cstddef>
#include <functional>
#include <string>

#include "rig/camera.h"
#include "rig/clock.h"
#include "rig/operator.h"
#include "rig/turntable.h"
#include "station/capture/metering.h"
#include "station/capture/plan.h"
#include "station/capture/session_folder.h"

namespace station {

struct RunDevices {
  rig::Camera& camera;
  rig::Turntable& turntable;
  rig::Operator& person;
  rig::Clock& clock;
};

struct Progress {
  std::size_t done = 0, total = 0;  // steps
  std::string step;                 // under way now; empty at the end
  double seconds_left = 0;          // median of this run's steps, before the first one StepDurations
};

struct RunOptions {
  rig::ExposureSettings settings;  // ISO and f-number of every picture; the exposure time where metering begins
  ChooseExposure choose_exposure;  // empty: no metering, every picture at `settings`
  int most_test_pictures = 8;      // for one picture
  // Looks at a picture before it is kept and throws std::runtime_error when it does not serve; may be empty.
  std::function<void(const PlanStep&, const rig::Picture&, double platform_reading_rad)> inspect;
  std::function<Eigen::Isometry3d(rig::Mounting)> nominal_holder_pose;  // platform_from_holder, required
  std::function<void(const Progress&)> progress;                        // may be empty
  std::function<bool()> should_stop;                          // asked between and within steps; may be empty
  double angle_tolerance_rad = 0.5 * std::numbers::pi / 180;  // |asked - read| of the platform
  StepDurations durations;
};

enum class RunOutcome { complete, interrupted };

// Takes every picture of the plan that the session does not have yet. A picture counts when the journal names it and
// its file has the journalled hash; other files in raw/ are discarded and their steps taken again. When nothing is
// missing no device is touched. Interrupted: the platform has been stopped and the stop record is on the disk.
// Errors: those of devices, operator and disk are rethrown after the platform was stopped and the stop was journalled
// (as far as the disk lets it); std::runtime_error for a plan or camera other than this session was started with, a
// platform that reads another angle than asked, a picture that is empty, was taken with other settings, or was
// delivered before.
RunOutcome run_plan(const Plan& plan, const RunDevices& devices, SessionFolder& session, const RunOptions& options);

}  // namespace station

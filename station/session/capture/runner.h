// Executes a capture plan on a rig, one durable record after the other (recorder.h), so that it may end at any instant
// and go on.
#pragma once

#include <Eigen/Geometry>
#include <cstddef>
#include <functional>
#include <string>
#include <vector>

#include "rig/devices/camera.h"
#include "rig/devices/clock.h"
#include "rig/devices/turntable.h"
#include "rig/people/operator.h"
#include "station/bench/metering.h"
#include "station/documents/degree.h"
#include "station/documents/plan.h"
#include "station/session/capture/lamp_watch.h"
#include "station/session/record/run_state.h"
#include "station/session/record/session_folder.h"
#include "station/session/record/verdict.h"

namespace station {

struct RunDevices {
  rig::Camera& camera;
  rig::Turntable& turntable;
  rig::Operator& person;
  rig::Clock& clock;
  // True: the pictures exist already and are handed out. Their times are in no order, and none can be waited for or
  // taken again. Whoever fills in the options of a run heeds it; run_plan does not.
  bool taken_before = false;
};

// pause: at the next safe point, the picture under way is finished first. now: whatever is under way is given up.
enum class StopWish { none, pause, now };

struct Progress {
  std::size_t done = 0, total = 0;  // steps
  std::string step;                 // under way now; empty at the end
  double seconds_left = 0;          // by the median of this run's steps, before the first one by StepDurations
  RunState state = RunState::running;
};

// What devices and checks give the runner. A function may be empty unless it is required.
struct RunOptions {
  // ISO and f-number of every picture; the exposure time where metering begins.
  rig::CameraSettings settings{.exposure_s = 0.125};
  ChooseExposure choose_exposure{};  // empty: no metering, every picture at `settings`
  int most_test_pictures = 8;        // for one picture
  ReadLamp read_lamp{};              // after the lamp was switched on, before its first view; empty: it is not watched
  LampWatch lamp_watch{};
  int most_attempts = 3;  // for one picture that may pass when it is taken again
  // The platform turns to the next view while a picture is looked at, in a thread of its own; never where the person
  // has to act first.
  bool turn_ahead = false;
  // Looks at a picture before it is kept. Throws std::runtime_error when it cannot be read at all.
  std::function<Verdict(const PlanStep&, const rig::Picture&, double platform_reading_rad)> inspect{};
  rig::BenchObject object = rig::BenchObject::holder;                     // what is photographed
  std::function<Eigen::Isometry3d(rig::Mounting)> nominal_holder_pose{};  // platform_from_object, required
  std::function<StopWish()> stop_wish{};                                  // asked between and within steps
  std::function<void(const Progress&)> progress{};
  std::function<void(const PlanStep&, const Verdict&)> judged{};  // is told of each picture
  std::function<void(const std::string&)> said{};                 // takes a line for the person while the run waits
  // Asked where the platform's tags differ by `tags_differ_rad` from the turntable's reading before any picture has
  // confirmed that reading. Returns the angle (radians) at which the platform truly stands, or nothing where it
  // slipped. An empty function: it slipped.
  std::function<std::optional<double>(double reading_rad, double tags_differ_rad)> settle_place{};
  std::vector<std::string> reshoot{};          // steps to take again although they have a picture
  double angle_tolerance_rad = 0.5 * kDegree;  // |asked - read| of the platform
  StepDurations durations{};
};

// Takes every picture of the plan that the session does not have yet, or that is to be taken again, and returns
// complete, paused or aborted. When nothing is missing no device is touched. The stop record is on the disk before the
// platform is stopped and devices are left.
//
// A picture that does not serve goes to refused/; where the next one may, it is taken again. When what was found (the
// platform slipped, camera or table were moved, the lamp changed, the focus is lost) may have happened earlier, the
// views since the last one that showed the contrary are withdrawn and taken again by the next run. A platform that
// stands elsewhere than its turntable believes from the beginning is no slip: see settle_place.
//
// Errors: those of devices and operator, BenchFault where a device answers and does not do what it was asked or a
// picture shows that the bench moved, and those of pictures that do not serve: the session is suspended and says so (as
// far as the disk lets it); RecordingFailed of the disk: failed. std::runtime_error for a plan or camera other than
// this session was started with, and for a step to be taken again that the plan does not have.
RunState run_plan(const Plan& plan, const RunDevices& devices, SessionFolder& session, const RunOptions& options);

}  // namespace station

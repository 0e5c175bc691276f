#include "station/session/run_session.h"

#include <stdexcept>

#include "station/bench/mounted_holder.h"
#include "station/session/checks/capture_checks.h"
#include "station/session/replay/device_log.h"

namespace station {

std::vector<std::string> steps_to_reshoot(const Plan& plan, const std::vector<std::string>& asked) {
  std::vector<std::string> steps;
  for (const std::string& name : asked) {
    std::string id = name;
    if (!name.empty() && name.find_first_not_of("0123456789") == std::string::npos) {
      const PlanStep* view = name.size() < 4 ? find_view(plan, std::stoul(name)) : nullptr;
      if (view == nullptr)
        throw std::runtime_error("view " + name + " was to be taken again; the plan has views 1 to " +
                                 std::to_string(view_count(plan)));
      id = view->id;
    }
    steps.push_back(id);
    for (const PlanStep& step : plan.steps)
      if (step.kind == StepKind::bracket && step.exposure_of == id) steps.push_back(step.id);
  }
  return steps;
}

RunState run_session(SessionFolder& session, const RunDevices& devices, const SessionFile& asked,
                     const RigCalibration& calibration, const CaptureRequest& request, RunOptions options) {
  CaptureChecks checks(session, asked, calibration, !devices.taken_before);
  options.choose_exposure = [&](const PlanStep& step, const rig::Picture& test) {
    return checks.choose_exposure(step, test);
  };
  options.inspect = [&](const PlanStep& step, const rig::Picture& picture, double reading_rad) {
    return checks.judge(step, picture, reading_rad);
  };
  options.nominal_holder_pose = [&](rig::Mounting mounting) { return nominal_pose(asked.rig, asked.spool, mounting); };
  if (asked.spool.fabric) options.object = rig::BenchObject::cylinder;
  if (devices.taken_before) {
    options.most_attempts = 1;
  } else {
    options.turn_ahead = asked.rig.turntable_driver != "manual";  // a person who turns it by hand is asked in time
    options.read_lamp = [&](const PlanStep& step, const rig::Picture& test) { return checks.read_lamp(step, test); };
    options.lamp_watch.interval_s = asked.rig.lamp_watch_s;
  }
  options.reshoot = steps_to_reshoot(asked.plan, request.reshoot);
  if (!request.record && !is_recorded(session.path())) return run_plan(asked.plan, devices, session, options);

  FileSystem disk;
  DeviceLog log(session.path(), request.reshoot, disk);
  const StandIns recorded = record_devices(
      devices, options.stop_wish ? options.stop_wish : [] { return StopWish::none; }, log);
  options.stop_wish = recorded.wish;
  options.choose_exposure = [&](const PlanStep& step, const rig::Picture& test) {
    log.keep_test(test);
    return checks.choose_exposure(step, test);
  };
  if (options.read_lamp)
    options.read_lamp = [&](const PlanStep& step, const rig::Picture& test) {
      log.keep_test(test);
      return checks.read_lamp(step, test);
    };
  return run_plan(asked.plan,
                  {*recorded.camera, *recorded.turntable, *recorded.person, devices.clock, devices.taken_before},
                  session, options);
}

}  // namespace station

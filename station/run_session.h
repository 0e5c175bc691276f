// One run of a session with its checks on devices that are connected, recorded ones or replayed ones.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "station/capture/runner.h"
#include "station/documents/calibration_file.h"
#include "station/documents/session_file.h"

namespace station {

struct SessionRun {
  std::vector<std::string> reshoot{};                   // views by their number, or steps by name, to take again
  rig::ExposureSettings settings{.exposure_s = 0.125};  // ISO and f-number of all pictures; where metering begins
  int most_attempts = 3;                                // for one picture
  bool in_order = true;  // pictures are made while this runs: a file older than the one before is stale
  bool record = false;   // write down all that the devices say (replay/device_log.h)
  std::function<StopWish()> stop_wish{};
  std::function<void(const Progress&)> progress{};
  std::function<void(const PlanStep&, const Verdict&)> judged{};
  std::function<void(const std::string&)> said{};  // while the run waits
};

// Errors: those of run_plan; std::runtime_error for a view to be taken again that the plan does not have.
RunState run_session(SessionFolder& session, const RunDevices& devices, const SessionFile& asked,
                     const RigCalibration& calibration, const SessionRun& run);

// The steps that `asked` names: a view by its number in the plan, or any step by its name; a view's further exposures
// go with it. Errors: std::runtime_error for a number that is no view's.
std::vector<std::string> steps_to_reshoot(const Plan& plan, const std::vector<std::string>& asked);

}  // namespace station

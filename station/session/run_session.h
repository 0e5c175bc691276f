// One run of a session with its checks, on devices that are connected, recorded ones or replayed ones.
#pragma once

#include <string>
#include <vector>

#include "station/documents/calibration_file.h"
#include "station/documents/session_file.h"
#include "station/session/capture/runner.h"
#include "station/session/capture_request.h"

namespace station {

// Runs the plan of an open session, following the request's `record` and `reshoot`. The caller's `options` are
// completed by what the rig file and the checks decide.
// Errors: those of run_plan; std::runtime_error for a view to be taken again that the plan does not have.
RunState run_session(SessionFolder& session, const RunDevices& devices, const SessionFile& asked,
                     const RigCalibration& calibration, const CaptureRequest& request, RunOptions options = {});

// The steps that `asked` names: a view by its number in the plan, or any step by its name; a view's further exposures
// go with it. Errors: std::runtime_error for a number that is no view's.
std::vector<std::string> steps_to_reshoot(const Plan& plan, const std::vector<std::string>& asked);

}  // namespace station

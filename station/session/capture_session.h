// The capture command's work: a new session from rig, calibration and spool, or an interrupted one continued.
#pragma once

#include <filesystem>

#include "rig/people/asked_person.h"
#include "station/documents/calibration_file.h"
#include "station/documents/plan.h"
#include "station/documents/rig_file.h"
#include "station/documents/spool.h"
#include "station/session/capture_request.h"
#include "station/session/record/run_state.h"
#include "station/session/record/session_folder.h"

namespace station {

// The plan that the rig file asks for; a cloth on the cylinder has one of its own.
Plan plan_of(const RigFile& rig, const Spool& spool);

// The files of a calibration (given as file or folder) that a session keeps: calibration.json, and the sensor's maps
// where the calibration has them.
CalibrationFiles calibration_files(const std::filesystem::path& calibration_path, const RigCalibration& calibration);

// Captures a new session or goes on with one. Ctrl-C stops the platform and pauses at the next safe point; a second one
// records the stop and ends the process. Errors: BenchFault for devices, calibration and plan, which every spool
// shares; std::runtime_error for files, pictures and disk. The session then says so in its journal and can be resumed.
RunState capture_session(const CaptureRequest& request);

}  // namespace station

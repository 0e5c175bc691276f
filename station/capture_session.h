// The capture command's work: a new session from rig, calibration and spool, or an interrupted one continued.
#pragma once

#include <filesystem>

#include "station/capture/runner.h"
#include "station/progress.h"

namespace station {

struct CaptureRequest {
  std::filesystem::path rig, calibration, spool;  // calibration: the folder that calibrate made
  std::filesystem::path out;                      // session folder
  bool unattended = false;
  bool accept_calibration = false;  // although gates of it failed
  ProgressStyle progress_style = ProgressStyle::automatic;
};

// Errors: std::runtime_error for files, devices and disk; the session then says so in its journal and can be resumed.
RunOutcome capture_session(const CaptureRequest& request);
RunOutcome resume_session(const std::filesystem::path& session, bool unattended, ProgressStyle progress_style);

}  // namespace station

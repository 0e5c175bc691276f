// The capture command's work: a new session from rig, calibration and spool, or an interrupted one continued.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "station/capture/runner.h"
#include "station/documents/calibration_file.h"
#include "station/documents/rig_file.h"
#include "station/documents/sample.h"
#include "station/documents/spool.h"
#include "station/progress.h"

namespace station {

struct CaptureRequest {
  std::filesystem::path rig, calibration, spool;  // calibration: the folder that calibrate made
  std::filesystem::path out;                      // session folder
  std::filesystem::path plan{};                   // a plan of one's own; empty: the rig file's
  std::string person{};                           // who captures
  std::optional<Sample> sample{};                 // its name and material take the place of the spool file's
  bool unattended = false;
  bool accept_calibration = false;  // although gates of it failed
  bool record = false;              // so that the session can be replayed: also test pictures are kept
  ProgressStyle progress_style = ProgressStyle::automatic;
};

// Of a wrapped thread, or of a cloth on the cylinder.
Plan plan_of(const RigFile& rig, const Spool& spool);

// What a session carries of a calibration (file or folder): calibration.json, and the sensor's maps where it has them.
CalibrationFiles calibration_files(const std::filesystem::path& calibration_path, const RigCalibration& calibration);

struct ResumeRequest {
  std::filesystem::path session;
  bool unattended = false;
  bool record = false;                 // a session that was recorded before goes on being recorded
  std::vector<std::string> reshoot{};  // views by their number, or steps by name, to take again
  ProgressStyle progress_style = ProgressStyle::automatic;
};

// Ctrl-C stops the platform and pauses at the next safe point; a second one records the stop and ends the process.
// Errors: std::runtime_error for files, devices and disk; the session then says so in its journal and can be resumed.
RunState capture_session(const CaptureRequest& request);
RunState resume_session(const ResumeRequest& request);

}  // namespace station

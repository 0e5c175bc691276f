// What a person asks of a capture. One request goes from the command down to the run, for a new session and for one
// that goes on.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "rig/people/asked_person.h"
#include "station/documents/sample.h"
#include "station/output/progress.h"

namespace station {

// What a new session is made of.
struct NewSession {
  std::filesystem::path rig, calibration, spool;  // calibration: the folder that calibrate made
  std::filesystem::path plan{};                   // a plan of one's own; empty: the rig file's
  std::string person{};                           // who captures
  std::optional<Sample> sample{};                 // its name and material take the place of the spool file's
  bool accept_calibration = false;                // although gates of it failed
};

struct CaptureRequest {
  std::filesystem::path session;            // its folder
  std::optional<NewSession> new_session{};  // nothing: the session that is in the folder goes on
  rig::AskedPerson* asked = nullptr;        // who answers questions; nobody: refused when the rig needs a person
  bool record = false;                 // so that the session can be replayed; a session once recorded goes on being so
  std::vector<std::string> reshoot{};  // views by their number, or steps by name, to take again
  ProgressStyle progress_style = ProgressStyle::automatic;
};

}  // namespace station

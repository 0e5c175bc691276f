// A recorded session played again through the same runner, checks and recorder: the recorded devices answer, faults
// included, and the clock tells the recorded times.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "station/capture/run_state.h"
#include "station/progress.h"

namespace station {

struct ReplayRequest {
  std::filesystem::path session;  // captured with --record
  std::filesystem::path out;
  bool resume = false;  // go on with a replay that was ended; its journal is its own then
  ProgressStyle progress_style = ProgressStyle::quiet;
};

struct ReplayReport {
  RunState state = RunState::idle;
  std::size_t files = 0, runs = 0;
  double recorded_s = 0;                 // by the journal's times
  std::vector<std::string> differences;  // files of the session that are not the same; one line each
};

// Compares session.json, journal.jsonl, raw/, refused/, calibration/ and replay/. Errors: std::runtime_error for a session
// that was not recorded or does not verify by its hashes, and where the program asks the devices for something else than
// the recorded one did.
ReplayReport replay_session(const ReplayRequest& request);

}  // namespace station

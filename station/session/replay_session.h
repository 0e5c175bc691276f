// A recorded session played again through the same runner, checks and recorder: the recorded devices answer, faults
// included, and the clock tells the recorded times.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "station/session/capture_request.h"
#include "station/session/record/run_state.h"

namespace station {

struct ReplayReport {
  RunState state = RunState::idle;
  std::size_t files = 0, runs = 0;
  double recorded_s = 0;                 // by the journal's times
  std::vector<std::string> differences;  // files of the session that are not the same; one line each
};

// Replays `recorded`, a session that was captured with --record. What it is made of and which pictures are taken again
// is as it was then, so that of `request` only the folder to make and the style of progress count. `resume`: goes on
// with a replay that was ended; its journal then differs from the recorded one.
// Compares session.json, journal.jsonl, raw/, refused/, calibration/ and replay/. Errors: std::runtime_error for a
// session that was not recorded or does not verify by its hashes, and where the program asks the devices for something
// else than the recorded one did.
ReplayReport replay_session(const std::filesystem::path& recorded, CaptureRequest request, bool resume = false);

}  // namespace station

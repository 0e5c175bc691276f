// Is a session what its journal says? Re-reads every file that is named there; changes nothing and needs no lock.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "station/capture/run_state.h"

namespace station {

struct VerifyReport {
  std::vector<std::string> problems;  // one line each; paths in the session folder
  std::size_t records = 0;            // of the journal, with an unbroken chain of checksums
  std::size_t files = 0;              // that were hashed
  std::size_t pictures = 0;           // steps with a picture that verifies
  std::size_t views = 0, views_planned = 0;
  RunState state = RunState::idle;
  bool complete = false;  // every step of the plan has its picture, and the last stop says so

  bool sound() const { return problems.empty(); }
};

// Problems: a file that differs, is missing or stands in raw/ without being named; session.json or a calibration file
// changed; a broken or torn journal; steps without a picture; a session that did not end. linear/, masks/ and result/
// can be made again and are checked against their manifest.json where there is one; refused/ by what the journal says of
// pictures that did not serve.
// Errors: std::runtime_error when `folder` is no session at all.
VerifyReport verify_session(const std::filesystem::path& folder);

}  // namespace station

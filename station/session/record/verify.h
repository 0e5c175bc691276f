// A check of whether a session is what its journal says: it reads every file again that is named there, changes nothing
// and needs no lock.
#pragma once

#include <cstddef>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "station/session/record/journal.h"
#include "station/session/record/run_state.h"

namespace station {

struct VerifyReport {
  std::vector<std::string> problems;  // one line each; paths relative to the session folder
  std::size_t records = 0;            // journal records with an unbroken chain of checksums
  std::size_t files = 0;              // number of files that were hashed
  std::size_t pictures = 0;           // steps with a picture whose hash is right
  std::size_t views = 0, views_planned = 0;
  RunState state = RunState::idle;
  bool complete = false;  // every step has its picture, and the journal ends with that outcome

  bool sound() const { return problems.empty(); }
};

// Verifies a session. Problems are: a file that differs, is missing, or is in raw/ without being named; session.json or
// a calibration file that changed; a broken or torn journal; steps without a picture; a session that did not end.
// linear/, masks/ and result/ can be made again and are checked against their manifest.json where there is one;
// refused/ is checked against the journal's records of refused pictures. Errors: std::runtime_error when `folder` is no
// session at all.
VerifyReport verify_session(const std::filesystem::path& folder);

// The files that the session began with, and their hashes: those of the journal's start, or of a later "upgraded";
// empty without a start.
std::map<std::string, std::string> fixed_files(const std::vector<JournalRecord>& records);

}  // namespace station

#include "station/session/record/run_state.h"

#include <algorithm>
#include <array>

namespace station {
namespace {

constexpr std::array kStates = {RunState::idle,      RunState::running,    RunState::pausing,  RunState::paused,
                                RunState::suspended, RunState::stopping,   RunState::complete, RunState::aborted,
                                RunState::failed,    RunState::interrupted};
constexpr std::array kNames = {"idle",     "running",  "pausing", "paused", "suspended",
                               "stopping", "complete", "aborted", "failed", "interrupted"};

}  // namespace

std::string state_name(RunState state) {
  return kNames.at(static_cast<std::size_t>(state));
}

RunState state_of(const std::vector<JournalRecord>& records, bool in_use) {
  const auto tells = [](const JournalRecord& record) {
    return record.event == "start" || record.event == "resume" || record.event == "stop";
  };
  const auto last = std::find_if(records.rbegin(), records.rend(), tells);
  if (last == records.rend()) return in_use ? RunState::running : RunState::idle;
  if (last->event != "stop") return in_use ? RunState::running : RunState::interrupted;
  const std::string outcome = last->data.value("outcome", std::string());
  const auto found =
      std::find_if(kStates.begin(), kStates.end(), [&](RunState state) { return state_name(state) == outcome; });
  return found == kStates.end() ? RunState::failed : *found;
}

}  // namespace station

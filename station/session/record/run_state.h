// The states of a capture session, and how they follow from its journal.
//
//   idle         the folder has been made, nothing has been done
//   running      steps are being taken
//   pausing      somebody asked for a pause; the picture under way is finished first
//   paused       ended at a safe point, can be resumed
//   suspended    a device, the bench or a picture needs a person; can then be resumed
//   stopping     somebody asked for a stop at once; the devices are being left
//   aborted      stopped at once; can be resumed all the same
//   complete     every step has its picture
//   failed       the journal or a picture could not be written
//   interrupted  the process or the power went away: there is no stop record, and nobody holds the session
// The states pausing and stopping pass within one process and are never the last word of a journal.
#pragma once

#include <string>
#include <vector>

#include "station/session/record/journal.h"

namespace station {

enum class RunState { idle, running, pausing, paused, suspended, stopping, complete, aborted, failed, interrupted };

std::string state_name(RunState state);  // the words above

// The state after these records; `in_use` says whether another process holds the session's lock.
RunState state_of(const std::vector<JournalRecord>& records, bool in_use);

}  // namespace station

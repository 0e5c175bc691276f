// The states of a capture session, and how its journal tells them.
//
//   idle         the folder is made, nothing has been done
//   running      steps are being taken
//   pausing      somebody asked for a pause; the picture under way is finished first
//   paused       ended at a safe point, to be resumed
//   suspended    a device, the bench or a picture needs a person; then to be resumed
//   stopping     ended at once on request; the devices are being left
//   aborted      that, and over; may be resumed all the same
//   complete     every step has its picture
//   failed       the journal or a picture could not be written
//   interrupted  the process or the power went away: no stop record, and nobody holds the session
// pausing and stopping pass within one process and are never the last word of a journal.
#pragma once

#include <string>
#include <vector>

#include "station/capture/journal.h"

namespace station {

enum class RunState { idle, running, pausing, paused, suspended, stopping, complete, aborted, failed, interrupted };

std::string state_name(RunState state);  // the words above

// `in_use`: another process holds the session's lock.
RunState state_of(const std::vector<JournalRecord>& records, bool in_use);

}  // namespace station

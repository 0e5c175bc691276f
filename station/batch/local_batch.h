// A batch on this computer: as many tasks at a time as its cores and its memory allow, each a process of its own.
#pragma once

#include <string>

#include "station/batch/batch_state.h"
#include "station/output/progress.h"

namespace station {

struct LocalRequest {
  int cores = 0;          // 0: all that this process may use
  double memory_gib = 0;  // 0: four fifths of what the computer has free
  ProgressStyle progress_style = ProgressStyle::automatic;
};

// Does all tasks that are not done; those that failed before are tried again. What cannot be done is left, and told of
// in the states that it returns. The caller holds the batch's lock. Errors: std::runtime_error, one line: ctrl-C, which
// is handed on to all tasks, and then the same batch goes on; a task that needs more cores than there are.
std::vector<TaskStatus> run_batch(const BatchWork& work, const LocalRequest& request);

}  // namespace station

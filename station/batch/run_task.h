// One task of a batch, done by whoever comes first: a local batch starts it as a process of its own, Slurm as a task of
// an array.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace station {

struct TaskRequest {
  std::filesystem::path folder;  // the batch's
  std::string step;
  int item = 0;
  std::vector<int> cores;  // the processor's, that it may use; empty: all that this process may
};

enum class TaskOutcome { done, kept };  // kept: it was done already

// Does the task unless it is up to date; waits while another process does it. Ctrl-C is handed on to the command, and
// the task is then as if it had not begun, but for what its command keeps. Errors: std::runtime_error, one line: where
// a task that it needs is not done, when it was stopped, when its record cannot be written, and when its command has
// failed, which its record tells then.
TaskOutcome run_task(const TaskRequest& request);

}  // namespace station

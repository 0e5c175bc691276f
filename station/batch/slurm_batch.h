// A batch that Slurm does: each step an array of jobs, of which a task begins when the tasks of the same item that it
// needs have ended well. Nothing of ours stays running: what Slurm has is asked of it, and what is done of the records.
//
//   <folder>/slurm/jobs.jsonl   a line before each array is submitted, and one with its number after it
//   <folder>/slurm/*.txt        what Slurm itself said of tasks
//
// Errors: those of slurm.h; std::runtime_error, one line.
#pragma once

#include <string>
#include <vector>

#include "station/batch/batch_state.h"

namespace station {

// The tasks that Slurm has of a batch, for states_of.
QueuedTasks queued_in_slurm(const BatchWork& work);
// Whether the batch was ever given to Slurm.
bool is_in_slurm(const BatchWork& work);
// The numbers of all jobs that Slurm still has of it, of steps and items that have left the plan, too.
std::vector<std::string> jobs_in_slurm(const BatchWork& work);
// What Slurm knows of tasks that died, into the states. Those that somebody cancelled, or that gave way, are stopped.
void explain_deaths(const BatchWork& work, std::vector<TaskStatus>& states);

struct Submitted {
  std::vector<std::string> jobs;  // their numbers
  std::size_t tasks = 0;
  std::size_t queued = 0;  // that Slurm had already
  std::string refused;     // why Slurm took no more, a line; empty: it took all
};
// Submits all tasks that are neither done nor with Slurm already, by whoever holds the batch's lock. Killed at any
// moment and called again, it submits what is left.
Submitted submit_batch(const BatchWork& work);

}  // namespace station

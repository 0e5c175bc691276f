// Slurm's own programs: sbatch, squeue, sacct, scancel and scontrol, as a person would type them.
//
// Errors: std::runtime_error, one line: a program that is missing, or what it said.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

namespace station {

// Tasks of an array have indices from 0 to this, without it.
int slurm_array_size();

// Submits a script and returns the number of the job. `options` are sbatch's.
std::string slurm_submit(const std::vector<std::string>& options, const std::string& script);

struct SlurmTask {
  std::string job;  // the array's number
  std::string name;
  int index = 0;
  std::string state, reason;  // such as "PENDING", "Dependency"
};
// All tasks of this user that wait or run.
std::vector<SlurmTask> slurm_queue();

// How jobs, by the number of each task's own, ended: such as "OUT_OF_MEMORY". Nothing where this Slurm keeps
// neither accounts nor a list of completed jobs.
std::optional<std::map<std::string, std::string>> slurm_ended(const std::vector<std::string>& jobs);

void slurm_cancel(const std::vector<std::string>& jobs);

// "0-3,7" for {0, 1, 2, 3, 7}.
std::string ranges_text(std::vector<int> numbers);

}  // namespace station

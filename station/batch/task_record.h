// How a task of a batch ended: the record in its folder, and the one that it leaves while it runs.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "station/batch/batch_work.h"
#include "station/batch/file_stamps.h"

namespace station {

struct TaskRecord {
  bool done = false;    // otherwise it failed
  std::string problem;  // of one that failed: the line that it said
  std::vector<std::string> arguments;
  std::string software;
  FileStamps inputs, outputs;
  double seconds = 0, processor_s = 0, peak_mib = 0;
  int attempts = 1;  // how often its command was begun for this
  std::string host, ended_utc;
};

// What is known of a task that has begun and has no record yet, or that died without one.
struct TaskBegun {
  int attempts = 1;            // with this one
  int deaths = 0;              // attempts before this one that left no record: killed, or out of memory or time
  bool stopped = false;        // it was stopped on request, and is no death
  std::string inputs_hash;     // of what the attempt read
  std::string host, job;       // where it ran; Slurm's number of it
  std::filesystem::path said;  // what the task said, beside what its command did
};

// Nothing where there is none. Errors: std::runtime_error, one line, for a file that is no record.
std::optional<TaskRecord> read_record(const std::filesystem::path& task_folder);
void write_record(const std::filesystem::path& task_folder, const TaskRecord& record);
void remove_record(const std::filesystem::path& task_folder);

std::optional<TaskBegun> read_begun(const std::filesystem::path& task_folder);
void write_begun(const std::filesystem::path& task_folder, const TaskBegun& begun);
void remove_begun(const std::filesystem::path& task_folder);

// Whether the task was done by the program of today as the plan has it now, from what is there now, and what it made
// is there unchanged.
bool is_up_to_date(const BatchWork& work, const BatchTask& task, const TaskRecord& record);

// What the command said; what the task said on this computer, and by Slurm's task of an array, both of which may be
// its names for them ("%A", "%a").
std::filesystem::path log_of(const std::filesystem::path& task_folder);
std::filesystem::path own_log_of(const std::filesystem::path& task_folder);
std::filesystem::path slurm_log_of(const std::filesystem::path& batch_folder, const std::string& step,
                                   const std::string& array, const std::string& index);

}  // namespace station

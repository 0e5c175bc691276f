#include "station/batch/run_task.h"

#include <sched.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <optional>
#include <stdexcept>
#include <thread>

#include "rig/devices/clock.h"
#include "station/batch/task_record.h"
#include "station/cloth/render/checkpoint.h"
#include "station/cloth/render/render_scene.h"
#include "station/documents/disk/folder_lock.h"
#include "station/documents/disk/sha256.h"
#include "station/documents/disk/stored_file.h"
#include "station/documents/session_file.h"
#include "station/output/child_process.h"
#include "station/output/interrupt.h"

namespace station {
namespace {

namespace fs = std::filesystem;
constexpr auto kBetweenTries = std::chrono::milliseconds(500);

std::runtime_error stop_of(const BatchTask& task) {
  return std::runtime_error(name_of(task) + " was stopped on request; the same batch goes on with it");
}

// Threads that are started later, by us and by the command, have the same.
void use_cores(const std::vector<int>& cores) {
  if (cores.empty()) return;
  cpu_set_t set;
  CPU_ZERO(&set);
  for (const int core : cores) CPU_SET(static_cast<std::size_t>(core), &set);
  sched_setaffinity(0, sizeof set, &set);
}

OpenFile locked(const fs::path& folder, const BatchTask& task) {
  FileSystem disk;
  for (;;) {
    if (std::optional<OpenFile> lock = try_lock_folder(folder, disk)) return std::move(*lock);
    if (interrupted()) throw stop_of(task);
    std::this_thread::sleep_for(kBetweenTries);
  }
}

void check_needs(const BatchWork& work, const BatchTask& task) {
  for (const BatchTask& need : needs_of(work, task)) {
    while (folder_in_use(task_folder(work, need))) {  // by somebody whom nobody knows of, such as a process whose
      if (interrupted()) throw stop_of(task);         // computer was given up
      std::this_thread::sleep_for(kBetweenTries);
    }
    const std::optional<TaskRecord> record = read_record(task_folder(work, need));
    if (record && record->done) continue;
    throw std::runtime_error(name_of(task) + " needs " + name_of(need) + ", which " +
                             (record ? "failed: " + record->problem : "is not done") +
                             "; put that right and run the batch again");
  }
}

// What an attempt with other inputs has left. Where they are the same, its command goes on with it, if it can.
void clear_result(const BatchWork& work, const BatchTask& task, bool same_inputs) {
  const fs::path result = result_of(work, task);
  if (result.empty()) return;
  std::error_code ignored;
  if (!same_inputs || task.step->command == "export") {
    fs::remove_all(result, ignored);
    fs::remove(checkpoint_of(result), ignored);  // of a rendering
    fs::remove(preview_of(result), ignored);
    if (task.step->command == "render") remove_parts(result);
  }
  make_folder(result.parent_path());
}

std::string host() {
  std::array<char, 256> name{};
  gethostname(name.data(), name.size() - 1);
  return name.data();
}

std::string from_slurm(const char* name) {
  const char* value = std::getenv(name);
  return value ? value : "";
}

}  // namespace

TaskOutcome run_task(const TaskRequest& request) {
  watch_interrupts(100);
  use_cores(request.cores);
  const BatchWork work = read_batch_work(request.folder);
  const BatchTask task = task_named(work, request.step, request.item);
  const fs::path folder = task_folder(work, task);
  make_task_folder(work, task);
  const OpenFile lock = locked(folder, task);
  check_needs(work, task);
  const std::optional<TaskRecord> last = read_record(folder);
  if (last && is_up_to_date(work, task, *last)) return TaskOutcome::kept;

  TaskRecord record{.arguments = arguments_of(work, task), .software = software_version(), .host = host()};
  record.inputs = stamps_of(inputs_of(work, task), last ? last->inputs : FileStamps{});
  std::string content = record.software + nlohmann::json(record.arguments).dump();
  for (const auto& [file, stamp] : record.inputs) content += stamp.sha256;
  const std::optional<TaskBegun> before = read_begun(folder);
  const std::string job = from_slurm("SLURM_JOB_ID");
  // Slurm begins the same job again after it gave way to another or lost its node: that tells nothing of what it needs.
  const bool died = before && !before->stopped && (job.empty() || before->job != job);
  TaskBegun begun{.attempts = before ? before->attempts + 1 : 1,
                  .deaths = before ? before->deaths + (died ? 1 : 0) : 0,
                  .inputs_hash = sha256_hex(content),
                  .host = record.host,
                  .job = job};
  begun.said = begun.job.empty() ? own_log_of(folder)
                                 : slurm_log_of(work.folder, task.step->name, from_slurm("SLURM_ARRAY_JOB_ID"),
                                                from_slurm("SLURM_ARRAY_TASK_ID"));
  clear_result(work, task, before && before->inputs_hash == begun.inputs_hash);
  write_begun(folder, begun);
  remove_record(folder);
  // Where this process is killed, nobody else begins while the command is still writing.
  const EndedProcess ended =
      run_own_program(arguments_of(work, task), log_of(folder), work.plan.folder, lock.descriptor());
  if (interrupted() && ended.status != 0) {
    TaskBegun again = begun;
    again.stopped = job.empty();  // Slurm knows why it ended a task (slurm_batch.h)
    write_begun(folder, again);
    throw stop_of(task);
  }
  if (ended.signal > 0)  // without a record: where memory ended, the next attempt is given more
    throw std::runtime_error(name_of(task) + " was killed by signal " + std::to_string(ended.signal) +
                             (ended.signal == SIGKILL ? ", perhaps because memory had ended" : ""));
  record.seconds = ended.seconds, record.processor_s = ended.processor_s, record.peak_mib = ended.peak_mib;
  record.attempts = begun.attempts;
  record.ended_utc = rig::SystemClock().utc();
  record.done = ended.status == 0;
  if (record.done) {
    record.outputs = stamps_of(outputs_of(work, task));
  } else {
    record.problem = last_words(log_of(folder));
    if (record.problem.empty()) record.problem = "it ended with status " + std::to_string(ended.status);
  }
  write_record(folder, record);
  remove_begun(folder);
  if (!record.done) throw std::runtime_error(name_of(task) + " failed: " + record.problem);
  return TaskOutcome::done;
}

}  // namespace station

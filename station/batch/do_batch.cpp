#include "station/batch/do_batch.h"

#include <signal.h>

#include <algorithm>
#include <chrono>
#include <fstream>
#include <stdexcept>
#include <thread>

#include "station/batch/batch_report.h"
#include "station/batch/slurm.h"
#include "station/batch/slurm_batch.h"
#include "station/documents/disk/folder_lock.h"
#include "station/documents/disk/stored_file.h"
#include "station/output/interrupt.h"

namespace station {
namespace {

namespace fs = std::filesystem;
constexpr int kBetweenPolls_s = 60;  // Slurm's advice is not to ask its controller in a loop

std::vector<TaskStatus> known_states(const BatchWork& work) {
  if (!is_in_slurm(work)) return states_of(work);
  std::vector<TaskStatus> states = states_of(work, queued_in_slurm(work));
  explain_deaths(work, states);
  return states;
}

std::size_t count_of(const std::vector<TaskStatus>& states, TaskState state) {
  return static_cast<std::size_t>(std::ranges::count(states, state, &TaskStatus::state));
}

void wait_for_slurm(const BatchWork& work, ProgressStyle style) {
  ProgressDisplay progress("batch", style);
  watch_interrupts();
  for (;;) {
    const std::vector<TaskStatus> states = known_states(work);
    const auto of = [&](TaskState state) { return static_cast<int>(count_of(states, state)); };
    progress.show(
        of(TaskState::done), static_cast<int>(states.size()),
        std::to_string(of(TaskState::running)) + " running, " + std::to_string(of(TaskState::queued)) + " queued");
    if (of(TaskState::running) + of(TaskState::queued) == 0) return;
    for (int i = 0; i < 10 * kBetweenPolls_s; ++i) {
      if (interrupted())
        throw std::runtime_error("no longer waiting; Slurm goes on with the batch, threadstation batch status " +
                                 work.folder.string() + " tells how far it is");
      std::this_thread::sleep_for(std::chrono::milliseconds(100));
    }
  }
}

// Whether the process of this number is a threadstation that does batches, on this computer.
bool does_batches(int process) {
  std::ifstream words("/proc/" + std::to_string(process) + "/cmdline");
  std::string program, command;
  std::getline(words, program, '\0');
  std::getline(words, command, '\0');
  return command == "batch";
}

}  // namespace

BatchOutcome do_batch(const DoBatchRequest& request) {
  make_folder(planned_batch(request.plan, request.folder).folder);
  FileSystem disk;
  std::optional<OpenFile> lock = try_lock_folder(request.folder, disk);
  if (!lock)
    throw std::runtime_error("the batch '" + request.folder.string() + "' is done by process " +
                             std::to_string(holder_of_lock(request.folder)) +
                             " already; wait until it ends, or stop it with threadstation batch cancel");
  const BatchWork work = planned_batch(request.plan, request.folder);  // now nobody else numbers items
  if (request.on == "local" && !jobs_in_slurm(work).empty())
    throw std::runtime_error("Slurm has tasks of the batch '" + work.folder.string() +
                             "'; wait for them, or take them back with threadstation batch cancel");
  store_batch(work);
  BatchOutcome outcome;
  std::vector<TaskStatus> states;
  if (request.on == "slurm") {
    const Submitted submitted = submit_batch(work);
    std::string jobs;
    for (const std::string& job : submitted.jobs) jobs += (jobs.empty() ? "" : ", ") + job;
    outcome.submitted = submitted.jobs.empty() ? "nothing is left to submit"
                                               : "submitted " + std::to_string(submitted.tasks) + " tasks as " +
                                                     std::to_string(submitted.jobs.size()) + " job array(s): " + jobs;
    if (submitted.queued > 0) outcome.submitted += "; Slurm had " + std::to_string(submitted.queued) + " already";
    outcome.submitted += "; threadstation batch status " + work.folder.string() + " tells how far they are";
    if (!submitted.refused.empty()) throw std::runtime_error(submitted.refused + " (" + outcome.submitted + ")");
    lock.reset();
    if (request.wait) wait_for_slurm(work, request.progress_style);
    states = known_states(work);
    outcome.bad = request.wait ? states.size() - count_of(states, TaskState::done) : 0;
  } else {
    LocalRequest local = request.local;
    local.progress_style = request.progress_style;
    states = run_batch(work, local);
    outcome.bad = states.size() - count_of(states, TaskState::done);
  }
  outcome.tasks = states.size();
  outcome.description = describe_batch(work, states);
  return outcome;
}

nlohmann::json batch_status(const fs::path& folder) {
  const BatchWork work = read_batch_work(folder);
  return describe_batch(work, known_states(work));
}

std::string cancel_batch(const fs::path& folder) {
  const BatchWork work = read_batch_work(folder);
  std::string done;
  if (folder_in_use(work.folder)) {
    const int process = holder_of_lock(work.folder);
    if (!does_batches(process))
      throw std::runtime_error("the batch is done by process " + std::to_string(process) +
                               " of another computer; stop it there, with ctrl-C");
    kill(process, SIGINT);
    done = "process " + std::to_string(process) + " was told to stop; what is done stays";
  }
  if (!is_in_slurm(work)) return done.empty() ? "nothing of it is running" : done;
  // What is being submitted at this moment is taken back as well.
  for (int i = 0; i < 50 && folder_in_use(work.folder); ++i)
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
  const std::vector<std::string> jobs = jobs_in_slurm(work);
  slurm_cancel(jobs);
  if (!jobs.empty()) done = "taken back from Slurm: " + std::to_string(jobs.size()) + " job array(s)";
  return done.empty() ? "nothing of it is running" : done;
}

}  // namespace station

#include "station/batch/batch_state.h"

#include <algorithm>
#include <cmath>

#include "station/documents/disk/folder_lock.h"
#include "station/output/child_process.h"

namespace station {
namespace {

namespace fs = std::filesystem;
using enum TaskState;

// Of a task that is not done, by what it has left behind.
void judge_remains(const fs::path& folder, TaskStatus& status) {
  const std::optional<TaskBegun> begun = read_begun(folder);
  if (begun) status.deaths = begun->deaths + (begun->stopped ? 0 : 1);
  if (begun && begun->stopped) {
    status.state = stopped;
  } else if (begun) {
    const std::string own = last_words(begun->said), last = own.empty() ? last_words(log_of(folder)) : own;
    status.state = died;
    status.why = "it ended on " + begun->host +
                 (last.empty() ? " without a word, killed or out of memory or time" : "; its last words: " + last);
  } else if (status.record && !status.record->done) {
    status.state = failed;
    status.why = status.record->problem;
  }
}

// By the needed tasks, which are judged already: all of the same item, earlier in the plan.
void judge_needs(const BatchWork& work, const std::vector<TaskStatus>& earlier, TaskStatus& status) {
  for (const BatchTask& need : needs_of(work, status.task)) {
    const TaskStatus& found = earlier[place_before(earlier, earlier.size(), need)];
    if (found.state == done) continue;
    status.state = is_bad(found.state) ? held : waiting;
    status.why = is_bad(found.state) ? "it needs " + name_of(need) + ": " + found.why : "";
    if (status.state == held) return;
  }
}

}  // namespace

const char* name_of(TaskState state) {
  constexpr const char* kNames[] = {"done",   "failed", "died",    "stopped", "running",
                                    "queued", "ready",  "waiting", "held"};
  return kNames[static_cast<std::size_t>(state)];
}

bool is_bad(TaskState state) {
  return state == failed || state == died || state == held;
}

std::size_t place_before(const std::vector<TaskStatus>& states, std::size_t end, const BatchTask& task) {
  while (states.at(end - 1).task.step != task.step || states[end - 1].task.item != task.item) --end;
  return end - 1;
}

std::vector<TaskStatus> states_of(const BatchWork& work, const QueuedTasks& queued) {
  std::vector<TaskStatus> all;
  for (const BatchTask& task : tasks_of(work)) {
    TaskStatus status{.task = task};
    const fs::path folder = task_folder(work, task);
    status.record = read_record(folder);
    judge_needs(work, all, status);
    const bool may_be_done = status.state == ready;
    if (folder_in_use(folder)) {
      status.state = running, status.why.clear();
    } else if (const auto at = queued.find(all.size()); at != queued.end()) {
      status.state = at->second == "RUNNING" ? running : TaskState::queued;
      status.why = at->second;
    } else if (may_be_done && status.record && is_up_to_date(work, task, *status.record)) {
      status.state = done;
    } else if (may_be_done) {
      judge_remains(folder, status);
    }
    all.push_back(std::move(status));
  }
  return all;
}

TaskNeeds expected_needs(const std::vector<TaskStatus>& all, const BatchStep& step) {
  constexpr double kMoreMemory = 1.3, kMoreTime = 3, kLeastMinutes = 2, kOwnMib = 100, kMib = 1024;
  TaskNeeds needs{.cores = step.cores, .memory_mib = step.memory_gib * kMib, .minutes = step.minutes};
  double peak_mib = 0, seconds = 0;
  for (const TaskStatus& other : all)
    if (other.task.step->name == step.name && other.record && other.record->done) {
      peak_mib = std::max(peak_mib, other.record->peak_mib);
      seconds = std::max(seconds, other.record->seconds);
    }
  if (peak_mib > 0) needs.memory_mib = kMoreMemory * peak_mib + kOwnMib;
  if (peak_mib > 0) needs.minutes = kLeastMinutes + kMoreTime * seconds / 60;
  return needs;
}

TaskNeeds after_deaths(TaskNeeds needs, int deaths) {
  constexpr int kMostDeaths = 3;
  const double factor = std::pow(2, std::min(deaths, kMostDeaths));
  needs.memory_mib *= factor, needs.minutes *= factor;
  return needs;
}

}  // namespace station

#include "station/batch/local_batch.h"

#include <sched.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <fstream>
#include <list>
#include <map>
#include <stdexcept>
#include <thread>

#include "station/output/child_process.h"
#include "station/output/interrupt.h"

namespace station {
namespace {

constexpr auto kBetweenLooks = std::chrono::milliseconds(20);

std::vector<int> own_cores() {
  cpu_set_t set;
  CPU_ZERO(&set);
  sched_getaffinity(0, sizeof set, &set);
  std::vector<int> cores;
  for (int core = 0; core < CPU_SETSIZE; ++core)
    if (CPU_ISSET(static_cast<std::size_t>(core), &set)) cores.push_back(core);
  return cores;
}

double free_mib() {
  std::ifstream lines("/proc/meminfo");
  std::string key, unit;
  for (double kib = 0; lines >> key >> kib; std::getline(lines, unit))
    if (key == "MemAvailable:") return kib / 1024;
  return 1024;
}

struct RunningTask {
  std::size_t number;  // in the states
  std::vector<int> cores;
  double memory_mib;
  ChildProcess process;
};

class LocalBatch {
 public:
  LocalBatch(const BatchWork& work, const LocalRequest& request)
      : work_(work), progress_("batch", request.progress_style), states_(states_of(work)), free_cores_(own_cores()) {
    if (request.cores > 0 && request.cores < static_cast<int>(free_cores_.size()))
      free_cores_.resize(static_cast<std::size_t>(request.cores));
    all_cores_ = static_cast<int>(free_cores_.size());
    free_mib_ = request.memory_gib > 0 ? 1024 * request.memory_gib : 0.8 * free_mib();
    for (const TaskStatus& status : states_)
      if (status.state != TaskState::done && status.task.step->cores > all_cores_)
        throw std::runtime_error(name_of(status.task) + " is to have " + std::to_string(status.task.step->cores) +
                                 " cores, and there are " + std::to_string(all_cores_) +
                                 "; give the step fewer, or --cores more");
    // Those that failed, or died, are tried again, and then what was held by them.
    for (TaskStatus& status : states_)
      if (status.state != TaskState::done) status.state = TaskState::waiting;
    for (const BatchStep& step : work_.plan.steps) expected_[&step] = expected_needs(states_, step);
    for (std::size_t i = 0; i < states_.size(); ++i) {
      needs_.emplace_back();
      for (const BatchTask& need : needs_of(work_, states_[i].task))
        needs_.back().push_back(place_before(states_, i, need));
    }
  }

  std::vector<TaskStatus> run() {
    for (int told = 0;;) {
      update();
      if (changed_ && !interrupted()) start_what_can_start();
      changed_ = false;
      if (running_.empty()) break;
      for (; told < interrupts(); ++told)
        for (const RunningTask& task : running_) task.process.signal(SIGINT);
      std::this_thread::sleep_for(kBetweenLooks);
    }
    if (interrupted())
      throw std::runtime_error("the batch was stopped on request with " + std::to_string(count(TaskState::done)) +
                               " of " + std::to_string(states_.size()) +
                               " tasks done; the same command goes on with it");
    progress_.finish(std::to_string(count(TaskState::done)) + " of " + std::to_string(states_.size()) + " tasks done");
    return states_;
  }

 private:
  std::size_t count(TaskState state) const {
    return static_cast<std::size_t>(std::ranges::count(states_, state, &TaskStatus::state));
  }

  // What has ended, and what that lets begin or holds. Nothing changes while nothing ends.
  void update() {
    for (auto at = running_.begin(); at != running_.end();) {
      const std::optional<EndedProcess> ended = at->process.ended();
      if (ended) finish(*at, *ended);
      at = ended ? running_.erase(at) : std::next(at);
    }
    for (std::size_t i = 0; changed_ && i < states_.size(); ++i)
      if (states_[i].state == TaskState::waiting) look_at_needs(i);
  }

  void look_at_needs(std::size_t number) {
    TaskStatus& status = states_[number];
    bool all_done = true;
    for (const std::size_t need : needs_[number]) {
      const TaskStatus& other = states_[need];
      all_done = all_done && other.state == TaskState::done;
      if (is_bad(other.state))
        status.state = TaskState::held, status.why = "it needs " + name_of(other.task) + ": " + other.why;
    }
    if (status.state == TaskState::waiting && all_done) status.state = TaskState::ready;
  }

  void finish(const RunningTask& ran, const EndedProcess& ended) {
    TaskStatus& status = states_[ran.number];
    free_cores_.insert(free_cores_.end(), ran.cores.begin(), ran.cores.end());
    free_mib_ += ran.memory_mib;
    const std::filesystem::path folder = task_folder(work_, status.task);
    status.record = read_record(folder);
    changed_ = true;
    if (status.record && status.record->done && ended.status == 0) {
      status.state = TaskState::done;
      expected_[status.task.step] = expected_needs(states_, *status.task.step);
    } else if (status.record && !status.record->done) {
      status.state = TaskState::failed, status.why = status.record->problem;
    } else {
      const std::string said = last_words(own_log_of(folder));
      status.state = TaskState::died;
      status.why = said.empty() ? "it was killed (status " + std::to_string(ended.status) + ")" : said;
    }
    if (!interrupted() && status.state != TaskState::done) progress_.note(name_of(status.task) + ": " + status.why);
    show(status.task);
  }

  void show(const BatchTask& task) {
    progress_.show(static_cast<int>(count(TaskState::done)), static_cast<int>(states_.size()), name_of(task));
  }

  void start_what_can_start() {
    for (std::size_t i = 0; i < states_.size() && !free_cores_.empty(); ++i) {
      TaskStatus& status = states_[i];
      if (status.state != TaskState::ready) continue;
      const BatchStep& step = *status.task.step;
      if (static_cast<std::size_t>(step.cores) > free_cores_.size()) continue;
      if (work_.plan.at_once > 0 && running_of(step) >= work_.plan.at_once) continue;
      const TaskNeeds needs = after_deaths(expected_.at(&step), status.deaths);
      if (needs.memory_mib > free_mib_ && !running_.empty()) continue;
      start(i, needs);
    }
  }

  int running_of(const BatchStep& step) const {
    return static_cast<int>(std::ranges::count_if(
        running_, [&](const RunningTask& ran) { return states_[ran.number].task.step == &step; }));
  }

  void start(std::size_t number, const TaskNeeds& needs) {
    TaskStatus& status = states_[number];
    const std::vector<int> cores(free_cores_.end() - needs.cores, free_cores_.end());
    std::string list;
    for (const int core : cores) list += (list.empty() ? "" : ",") + std::to_string(core);
    make_task_folder(work_, status.task);
    ChildProcess process({kOwnProgram, "batch", "task", work_.folder.string(), "--step", status.task.step->name,
                          "--item", std::to_string(status.task.item->number), "--cores", list},
                         own_log_of(task_folder(work_, status.task)), work_.folder);
    free_cores_.resize(free_cores_.size() - cores.size());
    free_mib_ -= needs.memory_mib;
    status.state = TaskState::running;
    running_.push_back({number, cores, needs.memory_mib, std::move(process)});
    show(status.task);
  }

  const BatchWork& work_;
  ProgressDisplay progress_;
  std::vector<TaskStatus> states_;
  std::vector<int> free_cores_;
  int all_cores_ = 0;
  double free_mib_ = 0;
  std::list<RunningTask> running_;
  std::map<const BatchStep*, TaskNeeds> expected_;  // of one task of each step, as far as is known
  bool changed_ = true;                             // since tasks were started last
  std::vector<std::vector<std::size_t>> needs_;     // of each task, by its place in the states
};

}  // namespace

std::vector<TaskStatus> run_batch(const BatchWork& work, const LocalRequest& request) {
  watch_interrupts(100);
  return LocalBatch(work, request).run();
}

}  // namespace station

#include "station/batch/slurm_batch.h"

#include <fcntl.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <fstream>
#include <set>
#include <span>
#include <stdexcept>
#include <tuple>

#include "station/batch/slurm.h"
#include "station/documents/disk/sha256.h"
#include "station/documents/disk/stored_file.h"
#include "station/output/child_process.h"

namespace station {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

// An array that was submitted, or was about to be.
struct Array {
  std::string name, step;
  int first = 0;  // the item of index 0
  std::vector<int> items;
  std::string job;  // empty: not known to have been submitted
};

// The journal of submissions.
class Arrays {
 public:
  explicit Arrays(const BatchWork& work) : file_(work.folder / "slurm" / "jobs.jsonl") {
    std::ifstream lines(file_);
    for (std::string line; std::getline(lines, line);) {
      const json said = json::parse(line, nullptr, false);  // a line may be torn
      if (!said.is_object()) continue;
      try {
        read(said);
      } catch (const json::exception&) {
        throw std::runtime_error(file_.string() + ": found " + line.substr(0, 60) +
                                 ", which is no line of it; restore the file from a copy");
      }
    }
  }

  const std::vector<Array>& all() const { return arrays_; }
  bool any() const { return !arrays_.empty(); }

  // Those whose submitting process died in between: Slurm knows them by their name, or never got them.
  void find_lost(const std::vector<SlurmTask>& queue) {
    for (Array& array : arrays_)
      for (const SlurmTask& task : queue)
        if (array.job.empty() && task.name == array.name) array.job = task.job;
  }

  Array& add(Array array) {
    make_folder(file_.parent_path());
    if (id_.empty()) {
      const auto now = std::chrono::system_clock::now().time_since_epoch().count();
      id_ = sha256_hex(file_.string() + std::to_string(now)).substr(0, 10);
      append({{"batch", id_}});
    }
    array.name = "threadstation-" + id_ + "-" + std::to_string(arrays_.size());
    append({{"array", array.name}, {"step", array.step}, {"first", array.first}, {"items", array.items}});
    arrays_.push_back(std::move(array));
    return arrays_.back();
  }
  void submitted(Array& array, const std::string& job) {
    array.job = job;
    append({{"job", job}, {"of", array.name}});
  }

 private:
  void read(const json& said) {
    if (said.contains("batch")) id_ = said["batch"];
    if (said.contains("array"))
      arrays_.push_back({said["array"], said.at("step"), said.at("first"), said.at("items"), ""});
    if (said.contains("job"))
      for (Array& array : arrays_)
        if (array.name == said.at("of")) array.job = said["job"];
  }

  // On the disk before anything that follows from it.
  void append(const json& line) const {
    const std::string text = (ends_torn() ? "\n" : "") + line.dump() + "\n";
    FileSystem disk;
    try {
      const OpenFile file = disk.open(file_, O_WRONLY | O_CREAT | O_APPEND);
      disk.write(file, std::as_bytes(std::span(text)));
      disk.sync(file);
    } catch (const std::system_error& error) {
      throw std::runtime_error(write_problem(file_, error.code()));
    }
  }

  bool ends_torn() const {  // by a full disk
    std::ifstream stream(file_, std::ios::binary | std::ios::ate);
    if (!stream || stream.tellg() == 0) return false;
    stream.seekg(-1, std::ios::end);
    return stream.get() != '\n';
  }

  fs::path file_;
  std::string id_;
  std::vector<Array> arrays_;
};

// By step and item.
using Places = std::map<std::pair<std::string, int>, std::size_t>;

Places places_of(const BatchWork& work) {
  Places places;
  for (const BatchTask& task : tasks_of(work))
    places.emplace(std::pair(task.step->name, task.item->number), places.size());
  return places;
}

struct Queue {
  QueuedTasks states;
  std::map<std::size_t, std::string> jobs;  // of tasks by their place
};

Queue queue_of(const BatchWork& work, Arrays& arrays) {
  Queue found;
  if (!arrays.any()) return found;
  const std::vector<SlurmTask> queue = slurm_queue();
  arrays.find_lost(queue);
  const Places places = places_of(work);
  for (const SlurmTask& task : queue)
    for (const Array& array : arrays.all()) {
      if (array.job != task.job) continue;
      const auto at = places.find({array.step, array.first + task.index});
      if (at == places.end()) continue;
      found.states[at->second] = task.state == "PENDING" ? "PENDING, " + task.reason : task.state;
      found.jobs[at->second] = task.job;
    }
  return found;
}

std::string quoted(const std::string& word) {
  std::string text = "'";
  for (const char c : word) text += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return text + "'";
}

std::string script_of(const BatchWork& work, const Array& array) {
  return "#!/bin/sh\nexec " + quoted(own_program_file()) + " batch task " + quoted(work.folder) + " --step " +
         quoted(array.step) + " --item $((" + std::to_string(array.first) + " + SLURM_ARRAY_TASK_ID))\n";
}

class Submission {
 public:
  Submission(const BatchWork& work, Arrays& arrays)
      : work_(work),
        arrays_(arrays),
        queue_(queue_of(work, arrays)),
        states_(states_of(work, queue_.states)),
        array_size_(slurm_array_size()) {
    explain_deaths(work, states_);
    for (const TaskStatus& status : states_)
      if (status.state == TaskState::stopped) remember_stop(status.task);
  }

  Submitted submit() {
    submitted_.queued = queue_.states.size();
    for (const BatchStep& step : work_.plan.steps) submit_step(step);
    return submitted_;
  }

 private:
  // Tasks that go into one array: they wait for the same jobs, and their items are near enough to each other.
  struct Group {
    std::set<std::string> after;
    int first = 0, deaths = 0;
    bool operator<(const Group& other) const {
      return std::tie(after, first, deaths) < std::tie(other.after, other.first, other.deaths);
    }
  };

  void submit_step(const BatchStep& step) {
    std::map<Group, std::vector<std::size_t>> groups;
    for (std::size_t i = 0; i < states_.size(); ++i) {
      const TaskStatus& status = states_[i];
      if (status.task.step != &step || status.state == TaskState::done || status.state == TaskState::running ||
          queue_.jobs.contains(i) || lacks_a_need(i))
        continue;
      Group group{.first = status.task.item->number / array_size_ * array_size_, .deaths = status.deaths};
      for (const BatchTask& need : needs_of(work_, status.task))
        if (const auto job = queue_.jobs.find(place_before(states_, i, need)); job != queue_.jobs.end())
          group.after.insert(job->second);
      groups[group].push_back(i);
    }
    for (const auto& [group, tasks] : groups) {
      try {
        submit_group(step, group, tasks);
      } catch (const std::runtime_error& problem) {
        submitted_.refused = problem.what();
      }
    }
  }

  // That what Slurm took back was no death, for as long as it is tried: the lists of completed jobs forget.
  void remember_stop(const BatchTask& task) const {
    const fs::path folder = task_folder(work_, task);
    std::optional<TaskBegun> begun = read_begun(folder);
    if (!begun || begun->stopped) return;
    begun->stopped = true;
    write_begun(folder, *begun);
  }

  // What it needs is neither done nor will be: Slurm took no more.
  bool lacks_a_need(std::size_t number) const {
    for (const BatchTask& need : needs_of(work_, states_[number].task)) {
      const std::size_t at = place_before(states_, number, need);
      const TaskState state = states_[at].state;
      if (state != TaskState::done && state != TaskState::running && !queue_.jobs.contains(at)) return true;
    }
    return false;
  }

  void submit_group(const BatchStep& step, const Group& group, const std::vector<std::size_t>& tasks) {
    Array wanted{.step = step.name, .first = group.first};
    std::vector<int> indices;
    for (const std::size_t task : tasks) {
      wanted.items.push_back(states_[task].task.item->number);
      indices.push_back(wanted.items.back() - group.first);
    }
    Array& array = arrays_.add(std::move(wanted));
    arrays_.submitted(array, slurm_submit(options_of(step, group, array, indices), script_of(work_, array)));
    for (const std::size_t task : tasks) queue_.jobs[task] = array.job;
    submitted_.jobs.push_back(array.job);
    submitted_.tasks += tasks.size();
  }

  std::vector<std::string> options_of(const BatchStep& step, const Group& group, const Array& array,
                                      const std::vector<int>& indices) const {
    const TaskNeeds needs = after_deaths(expected_needs(states_, step), group.deaths);
    std::vector<std::string> options{
        "--job-name=" + array.name,
        "--array=" + ranges_text(indices) +
            (work_.plan.at_once > 0 ? "%" + std::to_string(work_.plan.at_once) : std::string()),
        "--cpus-per-task=" + std::to_string(needs.cores),
        "--mem=" + std::to_string(static_cast<long>(std::ceil(needs.memory_mib))) + "M",
        "--time=" + std::to_string(static_cast<long>(std::ceil(needs.minutes))),
        "--requeue",
        "--open-mode=append",
        "--kill-on-invalid-dep=yes",
        "--chdir=" + work_.plan.folder.string(),
        "--output=" + slurm_log_of(work_.folder, step.name, "%A", "%a").string()};
    std::string after;
    for (const std::string& job : group.after) after += ":" + job;
    if (!after.empty()) options.push_back("--dependency=aftercorr" + after);
    options.insert(options.end(), work_.plan.slurm_options.begin(), work_.plan.slurm_options.end());
    return options;
  }

  const BatchWork& work_;
  Arrays& arrays_;
  Queue queue_;
  std::vector<TaskStatus> states_;
  int array_size_;
  Submitted submitted_;
};

void explain(TaskStatus& status, const std::string& job, const std::string& state) {
  const std::string words = "Slurm ended it as " + state + " (job " + job + ")";
  const bool for_others = state.starts_with("CANCELLED") || state.starts_with("PREEMPTED") || state == "NODE_FAIL";
  status.why = words + (for_others ? "" : "; " + status.why);
  if (!for_others) return;
  status.state = TaskState::stopped;
  status.deaths = std::max(0, status.deaths - 1);  // that tells nothing of what it needs
}

}  // namespace

bool is_in_slurm(const BatchWork& work) {
  return Arrays(work).any();
}

std::vector<std::string> jobs_in_slurm(const BatchWork& work) {
  Arrays arrays(work);
  if (!arrays.any()) return {};
  const std::vector<SlurmTask> queue = slurm_queue();
  arrays.find_lost(queue);
  std::set<std::string> jobs;
  for (const SlurmTask& task : queue)
    for (const Array& array : arrays.all())
      if (array.job == task.job) jobs.insert(task.job);
  return {jobs.begin(), jobs.end()};
}

QueuedTasks queued_in_slurm(const BatchWork& work) {
  Arrays arrays(work);
  return queue_of(work, arrays).states;
}

void explain_deaths(const BatchWork& work, std::vector<TaskStatus>& states) {
  std::map<std::string, TaskStatus*> dead;
  for (TaskStatus& status : states)
    if (status.state == TaskState::died)
      if (const auto begun = read_begun(task_folder(work, status.task)); begun && !begun->job.empty())
        dead[begun->job] = &status;
  std::vector<std::string> jobs;
  for (const auto& [job, status] : dead) jobs.push_back(job);
  const auto ended = slurm_ended(jobs);
  if (!ended) return;
  for (const auto& [job, state] : *ended)
    if (const auto status = dead.find(job); status != dead.end()) explain(*status->second, job, state);
}

Submitted submit_batch(const BatchWork& work) {
  Arrays arrays(work);
  return Submission(work, arrays).submit();
}

}  // namespace station

// How far a batch is: the state of each task, and what tasks of a step took so far.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "station/batch/task_record.h"

namespace station {

// done: up to date. failed: its command failed. died: it left no record, being killed or out of time or memory.
// stopped: on request. running: a process does it. queued: Slurm has it. ready: all that it needs is done. waiting: for
// a task that it needs; held: for one that failed.
enum class TaskState { done, failed, died, stopped, running, queued, ready, waiting, held };
inline constexpr TaskState kTaskStates[] = {TaskState::done,    TaskState::failed,  TaskState::died,
                                            TaskState::stopped, TaskState::running, TaskState::queued,
                                            TaskState::ready,   TaskState::waiting, TaskState::held};
const char* name_of(TaskState state);
bool is_bad(TaskState state);  // failed, died or held

struct TaskStatus {
  BatchTask task;
  TaskState state = TaskState::ready;
  std::string why;  // of one that failed, died or is held: a line
  std::optional<TaskRecord> record;
  int deaths = 0;
};

// What Slurm says of tasks that it has, by the task's place in tasks_of(): such as "PENDING" and its reason.
using QueuedTasks = std::map<std::size_t, std::string>;

// The states of tasks_of(work), in its order.
std::vector<TaskStatus> states_of(const BatchWork& work, const QueuedTasks& queued = {});

// The place of a task in the states, where it stands before `end`: tasks of one item stand together.
std::size_t place_before(const std::vector<TaskStatus>& states, std::size_t end, const BatchTask& task);

// What one task of the step will take, by those that have ended in this batch, or by the plan while none has; and one
// that has died: twice as much with each death, up to the third.
struct TaskNeeds {
  int cores = 1;
  double memory_mib = 0, minutes = 0;
};
TaskNeeds expected_needs(const std::vector<TaskStatus>& all, const BatchStep& step);
TaskNeeds after_deaths(TaskNeeds needs, int deaths);

}  // namespace station

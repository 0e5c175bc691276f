// The work of a batch: its plan and the items that its steps are done with, as the batch's folder keeps them.
//
//   <folder>/plan.json           the plan as it was given last
//   <folder>/items.json          all items, each with its number, which it keeps
//   <folder>/tasks/STEP/ITEM/    of one step with one item, a task: record.json when it has ended (task_record.h),
//                                log.txt, what it said; .lock, held while it runs
//   <folder>/results/STEP/ITEM   what it made, unless that belongs into the item's session
//   <folder>/slurm/              the jobs that Slurm was given (slurm_batch.h)
//
// Errors: std::runtime_error, one line.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "station/documents/batch_file.h"

namespace station {

struct BatchItem {
  int number = 0;  // from 0
  BatchItemKind kind = BatchItemKind::session;
  std::string name;            // of folders; no other item has it
  std::filesystem::path path;  // absolute
  bool planned = false;        // the plan as it is now has it
};

struct BatchWork {
  std::filesystem::path folder;  // absolute
  BatchFile plan;
  std::vector<BatchItem> items;  // all that the batch has ever had, by number
};

struct BatchTask {
  const BatchStep* step = nullptr;
  const BatchItem* item = nullptr;
};

// What a batch in a new or empty folder will be, or one that goes on by a plan that may have changed; nothing is
// written. Errors: also for names that nothing is found for, a session that is none, two items of one name, and a
// folder that holds something else.
BatchWork planned_batch(const std::filesystem::path& plan, const std::filesystem::path& folder);
// Writes plan and items, by whoever holds the folder's lock.
void store_batch(const BatchWork& work);
// A batch that has begun. Errors: also for a folder that is none.
BatchWork read_batch_work(const std::filesystem::path& folder);

// The planned tasks, item after item, in the order of the steps.
std::vector<BatchTask> tasks_of(const BatchWork& work);
// The tasks of the same item that it needs.
std::vector<BatchTask> needs_of(const BatchWork& work, const BatchTask& task);
BatchTask task_named(const BatchWork& work, const std::string& step, int item);
std::string name_of(const BatchTask& task);  // "invert of silk-red"

std::filesystem::path task_folder(const BatchWork& work, const BatchTask& task);
void make_task_folder(const BatchWork& work, const BatchTask& task);
// The words after the program's name.
std::vector<std::string> arguments_of(const BatchWork& work, const BatchTask& task);
// The files that it reads, and those that it has made, as they are there now; absolute, sorted.
std::vector<std::filesystem::path> inputs_of(const BatchWork& work, const BatchTask& task);
std::vector<std::filesystem::path> outputs_of(const BatchWork& work, const BatchTask& task);
// What it makes outside a session: a file or folder of its own; empty otherwise.
std::filesystem::path result_of(const BatchWork& work, const BatchTask& task);

}  // namespace station

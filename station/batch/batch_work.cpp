#include "station/batch/batch_work.h"

#include <glob.h>

#include <algorithm>
#include <stdexcept>

#include "station/cloth/render/render_identity.h"
#include "station/documents/disk/file_name.h"
#include "station/documents/disk/folder_lock.h"
#include "station/documents/disk/stored_file.h"
#include "station/documents/migrations.h"
#include "station/documents/reader.h"
#include "station/session/record/session_folder.h"
#include "station/session/results.h"

namespace station {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

constexpr const char* kItems = "batch-items";

fs::path plan_of(const fs::path& folder) {
  return folder / "plan.json";
}
fs::path items_of(const fs::path& folder) {
  return folder / "items.json";
}

// What a name of the plan stands for. With a wildcard only what may be meant counts, without one all.
std::vector<fs::path> found(const BatchFile& plan, const std::string& name, BatchItemKind kind) {
  const std::string pattern = (plan.folder / name).lexically_normal().string();
  if (pattern.find_first_of("*?[") == std::string::npos) return {pattern};
  glob_t matches{};
  std::vector<fs::path> paths;
  if (glob(pattern.c_str(), 0, nullptr, &matches) == 0)
    for (std::size_t i = 0; i < matches.gl_pathc; ++i) {
      const fs::path path = matches.gl_pathv[i];
      if (kind == BatchItemKind::session ? is_session(path) : path.extension() == ".json") paths.push_back(path);
    }
  globfree(&matches);
  return paths;
}

// "8" of the file of figure 8.
std::string number_of_figure(const fs::path& file) {
  const json document = read_json_file(file);
  if (const auto number = document.find("figure"); number != document.end() && number->is_string()) return *number;
  throw std::runtime_error("'" + file.string() + "' describes no figure; name files of figures in \"figures\"");
}

void check(const BatchFile& plan, const fs::path& path, BatchItemKind kind) {
  std::error_code ignored;
  if (kind == BatchItemKind::session ? is_session(path) : fs::is_regular_file(path, ignored)) {
    if (kind == BatchItemKind::figure) number_of_figure(path);
    return;
  }
  throw std::runtime_error(plan.source + ": '" + path.string() + "' is no " + name_of(kind) +
                           (kind == BatchItemKind::session ? "'s folder" : " file") + "; check the name in \"" +
                           name_of(kind) + "s\"");
}

// "silk_red" for .../silk_red.json; a session's fit is called as the session.
std::string name_for(const fs::path& path, BatchItemKind kind) {
  const fs::path whole = path.has_filename() ? path : path.parent_path();
  if (kind == BatchItemKind::session) return safe_name(whole.filename().string());
  for (fs::path above = whole.parent_path(); above.has_relative_path(); above = above.parent_path())
    if (kind == BatchItemKind::thread && is_session(above)) return safe_name(above.filename().string());
  return safe_name(whole.stem().string());
}

std::vector<BatchItem> wanted_items(const BatchFile& plan) {
  std::vector<BatchItem> items;
  for (const BatchItemKind kind : kBatchItemKinds)
    for (const std::string& name : plan.names_of(kind)) {
      const std::vector<fs::path> paths = found(plan, name, kind);
      if (paths.empty())
        throw std::runtime_error(plan.source + ": nothing is found for \"" + name + "\" in \"" + name_of(kind) +
                                 "s\"; check the name, which counts from " + plan.folder.string());
      for (const fs::path& path : paths) {
        check(plan, path, kind);
        BatchItem item{.kind = kind, .name = name_for(path, kind), .path = path, .planned = true};
        if (const auto problem = problem_with_name(item.name))
          throw std::runtime_error(plan.source + ": '" + path.string() + "' cannot be called \"" + item.name +
                                   "\": " + *problem + "; rename it");
        const auto same = std::ranges::find(items, item.name, &BatchItem::name);
        if (same != items.end() && same->path != item.path)
          throw std::runtime_error(plan.source + ": '" + same->path.string() + "' and '" + path.string() +
                                   "' would both be called \"" + item.name + "\"; rename one of them");
        if (same == items.end()) items.push_back(item);
      }
    }
  return items;
}

// Anything but the lock of a batch that is about to begin.
bool holds_other_things(const fs::path& folder) {
  std::error_code none;
  for (fs::directory_iterator entry(folder, none), end; !none && entry != end; entry.increment(none))
    if (entry->path().filename() != kLockFile) return true;
  return false;
}

json to_json(const std::vector<BatchItem>& items) {
  json list = json::array();
  for (const BatchItem& item : items)
    list.push_back({{"number", item.number},
                    {"kind", name_of(item.kind)},
                    {"name", item.name},
                    {"path", item.path.string()},
                    {"planned", item.planned}});
  return {{"format", std::string("threadstation/") + kItems}, {"version", current_version(kItems)}, {"items", list}};
}

std::vector<BatchItem> read_items(const fs::path& file) {
  const json document = read_json_file(file);
  ObjectReader reader(document, file.string(), kItems);
  std::vector<BatchItem> items;
  for (ObjectReader& one : reader.objects("items")) {
    BatchItem item{.number = one.integer("number", 0, 1 << 30)};
    const std::string kind = one.text("kind");
    const auto known =
        std::ranges::find_if(kBatchItemKinds, [&](BatchItemKind other) { return kind == name_of(other); });
    if (known == std::end(kBatchItemKinds)) one.refuse("kind", "found \"" + kind + "\", which is no kind of item");
    item.kind = *known;
    item.name = one.text("name"), item.path = one.text("path"), item.planned = one.flag("planned");
    one.finish();
    items.push_back(item);
  }
  reader.finish();
  return items;
}

// All regular files below a folder, or the file itself.
void add_files(std::vector<fs::path>& files, const fs::path& at) {
  std::error_code none;
  if (fs::is_regular_file(at, none)) files.push_back(at);
  for (fs::recursive_directory_iterator entry(at, none), end; !none && entry != end; entry.increment(none))
    if (entry->is_regular_file(none) && !is_left_over(entry->path())) files.push_back(entry->path());
}

std::vector<fs::path> sorted(std::vector<fs::path> files) {
  std::ranges::sort(files);
  files.erase(std::ranges::unique(files).begin(), files.end());
  return files;
}

// What the report writes into the folder of results that it reads.
constexpr const char* kOfReport[] = {"contact_sheet.png", "models.png", "overview.png", "manifest.json"};

fs::path thread_of(const BatchTask& task) {
  return task.item->kind == BatchItemKind::session ? model_file_of(task.item->path, task.step->model) : task.item->path;
}

void add_inputs(std::vector<fs::path>& files, const BatchTask& task) {
  const fs::path& at = task.item->path;
  const std::string& command = task.step->command;
  if (command == "cloth" || command == "export") {
    files.push_back(thread_of(task));
  } else if (command == "render") {
    for (const fs::path& file : files_of_scene(at)) files.push_back(file);
  } else if (command == "validate" || command == "reproduce") {
    files.push_back(at);
  } else {
    files.push_back(at / "session.json");
    for (const char* folder : {"calibration", command == "develop" ? "raw" : "linear"}) add_files(files, at / folder);
    if (command != "invert") files.push_back(at / "journal.jsonl");
    if (command != "develop") add_files(files, at / "masks");
    if (command == "report") {
      add_files(files, at / "result");
      for (const char* own : kOfReport) std::erase(files, at / "result" / own);
    }
  }
}

}  // namespace

BatchWork planned_batch(const fs::path& plan, const fs::path& folder) {
  BatchWork work{.folder = fs::absolute(folder).lexically_normal(), .plan = read_batch(plan)};
  std::error_code ignored;
  const bool goes_on = fs::exists(items_of(work.folder), ignored);
  if (!goes_on && holds_other_things(work.folder))
    throw std::runtime_error("'" + folder.string() + "' holds other things than a batch; give --out a new folder");
  const std::vector<BatchItem> wanted = wanted_items(work.plan);
  if (goes_on) work.items = read_items(items_of(work.folder));
  for (BatchItem& item : work.items) item.planned = false;
  for (const BatchItem& item : wanted) {
    const auto known = std::ranges::find(work.items, item.name, &BatchItem::name);
    if (known == work.items.end()) {
      work.items.push_back(item);
      work.items.back().number = static_cast<int>(work.items.size()) - 1;
    } else {
      known->kind = item.kind, known->path = item.path, known->planned = true;
    }
  }
  for (const BatchStep& step : work.plan.steps)
    if (std::ranges::none_of(wanted, [&](const BatchItem& item) { return is_for(step, item.kind); }))
      throw std::runtime_error(work.plan.source + ": the step \"" + step.name +
                               "\" has nothing that it could be done with; give it " + kKindsOfItems +
                               ", or take it out");
  return work;
}

void store_batch(const BatchWork& work) {
  write_json_file(plan_of(work.folder), work.plan.document);
  write_json_file(items_of(work.folder), to_json(work.items));
}

BatchWork read_batch_work(const fs::path& folder) {
  BatchWork work{.folder = fs::absolute(folder).lexically_normal()};
  std::error_code ignored;
  if (!fs::exists(items_of(work.folder), ignored))
    throw std::runtime_error("'" + folder.string() + "' is no batch (it has no items.json); name the folder that a " +
                             "batch was given with --out");
  work.plan = read_batch(plan_of(work.folder));
  work.items = read_items(items_of(work.folder));
  return work;
}

std::vector<BatchTask> tasks_of(const BatchWork& work) {
  std::vector<BatchTask> tasks;
  for (const BatchItem& item : work.items)
    for (const BatchStep& step : work.plan.steps)
      if (item.planned && is_for(step, item.kind)) tasks.push_back({&step, &item});
  return tasks;
}

std::vector<BatchTask> needs_of(const BatchWork& work, const BatchTask& task) {
  std::vector<BatchTask> needs;
  for (const std::string& name : task.step->needs)
    if (const BatchStep* step = work.plan.step(name); step && is_for(*step, task.item->kind))
      needs.push_back({step, task.item});
  return needs;
}

BatchTask task_named(const BatchWork& work, const std::string& step, int item) {
  const BatchStep* found = work.plan.step(step);
  if (!found || item < 0 || item >= static_cast<int>(work.items.size()) ||
      !work.items[static_cast<std::size_t>(item)].planned)
    throw std::runtime_error("the batch '" + work.folder.string() + "' has no step \"" + step + "\" with an item " +
                             std::to_string(item) + "; its plan has changed: run threadstation batch again");
  return {found, &work.items[static_cast<std::size_t>(item)]};
}

std::string name_of(const BatchTask& task) {
  return task.step->name + " of " + task.item->name;
}

fs::path task_folder(const BatchWork& work, const BatchTask& task) {
  return work.folder / "tasks" / task.step->name / task.item->name;
}

void make_task_folder(const BatchWork& work, const BatchTask& task) {
  const fs::path folder = task_folder(work, task), step = folder.parent_path();
  for (const fs::path& one : {step.parent_path(), step, folder}) make_folder(one);
}

fs::path result_of(const BatchWork& work, const BatchTask& task) {
  const fs::path place = work.folder / "results" / task.step->name / task.item->name;
  const std::string& command = task.step->command;
  if (command == "render") return place.string() + ".exr";
  return is_for(*task.step, BatchItemKind::session) && command != "cloth" && command != "export" ? fs::path() : place;
}

std::vector<std::string> arguments_of(const BatchWork& work, const BatchTask& task) {
  const BatchStep& step = *task.step;
  std::vector<std::string> words{step.command};
  if (step.command == "export") words.emplace_back("thread");
  if (step.command == "validate")
    words.insert(words.end(), {"--spool", task.item->path.string()});
  else if (step.command == "reproduce")
    words.push_back(number_of_figure(task.item->path));
  else
    words.push_back(step.command == "cloth" || step.command == "export" ? thread_of(task).string()
                                                                        : task.item->path.string());
  if (step.command == "invert" && step.model != "thread") words.insert(words.end(), {"--model", step.model});
  const fs::path result = result_of(work, task);
  if (!result.empty()) words.insert(words.end(), {"--out", result.string()});
  words.insert(words.end(), step.options.begin(), step.options.end());
  return words;
}

std::vector<fs::path> inputs_of(const BatchWork& work, const BatchTask& task) {
  std::vector<fs::path> files;
  add_inputs(files, task);
  for (const std::string& option : task.step->options) {  // a draft, a rig
    std::error_code none;
    const fs::path file = (work.plan.folder / option).lexically_normal();
    if (!option.empty() && fs::is_regular_file(file, none)) files.push_back(file);
  }
  return sorted(std::move(files));
}

std::vector<fs::path> outputs_of(const BatchWork& work, const BatchTask& task) {
  const fs::path& at = task.item->path;
  const std::string& command = task.step->command;
  std::vector<fs::path> files;
  if (command == "develop") {
    for (const char* folder : {"linear", "masks"}) add_files(files, at / folder);
  } else if (command == "invert") {
    const fs::path results = results_of(at, task.step->model);
    if (task.step->model == "thread")
      for (const char* part : {"thread.json", "fitted", "residual"}) add_files(files, results / part);
    else
      add_files(files, results);
  } else if (command == "report") {
    add_files(files, at / "report.html");
    for (const char* own : kOfReport) add_files(files, at / "result" / own);
  } else {
    const fs::path result = result_of(work, task);
    add_files(files, result);
    if (command == "render") add_files(files, fs::path(result).replace_extension(".png"));
  }
  return sorted(std::move(files));
}

}  // namespace station

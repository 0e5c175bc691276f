#include "station/batch/task_record.h"

#include "station/documents/migrations.h"
#include "station/documents/reader.h"
#include "station/documents/session_file.h"

namespace station {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

constexpr const char* kRecord = "batch-task";

fs::path record_of(const fs::path& task_folder) {
  return task_folder / "record.json";
}
fs::path begun_of(const fs::path& task_folder) {
  return task_folder / "begun.json";
}

TaskRecord parse_record(const json& document, const std::string& source) {
  ObjectReader reader(document, source, kRecord);
  TaskRecord record{.done = reader.choice("ended", {"well", "badly"}) == "well",
                    .problem = reader.text("problem"),
                    .arguments = reader.raw("arguments").get<std::vector<std::string>>(),
                    .software = reader.text("software"),
                    .inputs = parse_stamps(reader.raw("inputs")),
                    .outputs = parse_stamps(reader.raw("outputs"))};
  constexpr double kMost = 1e12;
  record.seconds = reader.number("seconds", 0, kMost);
  record.processor_s = reader.number("processor_s", 0, kMost);
  record.peak_mib = reader.number("peak_mib", 0, kMost);
  record.attempts = reader.integer("attempts", 1, 1 << 30);
  record.host = reader.text("host");
  record.ended_utc = reader.text("ended_utc");
  reader.finish();
  return record;
}

std::runtime_error damaged(const fs::path& file) {
  return std::runtime_error(file.string() + ": is damaged; remove it, and the batch does that task again");
}

}  // namespace

std::optional<TaskRecord> read_record(const fs::path& task_folder) {
  const fs::path file = record_of(task_folder);
  std::error_code ignored;
  if (!fs::exists(file, ignored)) return std::nullopt;
  const json document = read_json_file(file);
  try {
    return parse_record(document, file.string());
  } catch (const json::exception&) {
    throw damaged(file);
  }
}

void write_record(const fs::path& task_folder, const TaskRecord& record) {
  write_json_file(record_of(task_folder), {{"format", std::string("threadstation/") + kRecord},
                                           {"version", current_version(kRecord)},
                                           {"ended", record.done ? "well" : "badly"},
                                           {"problem", record.problem},
                                           {"arguments", record.arguments},
                                           {"software", record.software},
                                           {"inputs", to_json(record.inputs)},
                                           {"outputs", to_json(record.outputs)},
                                           {"seconds", record.seconds},
                                           {"processor_s", record.processor_s},
                                           {"peak_mib", record.peak_mib},
                                           {"attempts", record.attempts},
                                           {"host", record.host},
                                           {"ended_utc", record.ended_utc}});
}

void remove_record(const fs::path& task_folder) {
  std::error_code ignored;
  fs::remove(record_of(task_folder), ignored);
}

std::optional<TaskBegun> read_begun(const fs::path& task_folder) {
  std::error_code ignored;
  if (!fs::exists(begun_of(task_folder), ignored)) return std::nullopt;
  const json document = read_json_file(begun_of(task_folder));
  try {
    return TaskBegun{.attempts = document.value("attempts", 1),
                     .deaths = document.value("deaths", 0),
                     .stopped = document.value("stopped", false),
                     .inputs_hash = document.value("inputs_hash", ""),
                     .host = document.value("host", ""),
                     .job = document.value("job", ""),
                     .said = document.value("said", "")};
  } catch (const json::exception&) {
    throw damaged(begun_of(task_folder));
  }
}

void write_begun(const fs::path& task_folder, const TaskBegun& begun) {
  write_json_file(begun_of(task_folder), {{"attempts", begun.attempts},
                                          {"deaths", begun.deaths},
                                          {"stopped", begun.stopped},
                                          {"inputs_hash", begun.inputs_hash},
                                          {"host", begun.host},
                                          {"job", begun.job},
                                          {"said", begun.said.string()}});
}

void remove_begun(const fs::path& task_folder) {
  std::error_code ignored;
  fs::remove(begun_of(task_folder), ignored);
}

bool is_up_to_date(const BatchWork& work, const BatchTask& task, const TaskRecord& record) {
  if (!record.done || record.software != software_version() || record.arguments != arguments_of(work, task))
    return false;
  try {
    return same_content(stamps_of(inputs_of(work, task), record.inputs), record.inputs) &&
           same_content(stamps_of(outputs_of(work, task), record.outputs), record.outputs);
  } catch (const std::runtime_error&) {
    return false;  // what cannot be read any more is made again, or told by the command that needs it
  }
}

fs::path log_of(const fs::path& task_folder) {
  return task_folder / "log.txt";
}

fs::path own_log_of(const fs::path& task_folder) {
  return task_folder / "task.txt";
}

fs::path slurm_log_of(const fs::path& batch_folder, const std::string& step, const std::string& array,
                      const std::string& index) {
  return batch_folder / "slurm" / (step + "-" + array + "_" + index + ".txt");
}

}  // namespace station

#include "station/documents/batch_file.h"

#include <algorithm>
#include <initializer_list>
#include <map>
#include <stdexcept>

#include "station/documents/disk/file_name.h"
#include "station/documents/reader.h"

namespace station {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using enum BatchItemKind;

// What each command is done with.
const std::map<std::string, std::vector<BatchItemKind>>& commands() {
  static const std::map<std::string, std::vector<BatchItemKind>> all{
      {"develop", {session}},        {"invert", {session}}, {"report", {session}}, {"cloth", {session, thread}},
      {"export", {session, thread}}, {"render", {scene}},   {"validate", {spool}}, {"reproduce", {figure}}};
  return all;
}

// The commands whose results a command reads.
const std::map<std::string, std::vector<std::string>>& commands_before() {
  static const std::map<std::string, std::vector<std::string>> all{
      {"invert", {"develop"}}, {"report", {"invert"}}, {"cloth", {"invert"}}, {"export", {"invert"}}};
  return all;
}

std::vector<std::string> texts(ObjectReader& reader, const std::string& key) {
  if (!reader.has(key)) return {};
  const json& list = reader.raw(key);
  if (!list.is_array() || !std::ranges::all_of(list, [](const json& one) { return one.is_string(); }))
    reader.refuse(key, "expected a list of texts");
  return list.get<std::vector<std::string>>();
}

// What the batch gives itself.
void check_options(ObjectReader& reader, const BatchStep& step) {
  for (const std::string& option : step.options)
    for (const std::string own : {"--out", "--json", "--quiet", "--spool", "--model"})
      if ((option == own || option.starts_with(own + "=")) && !(own == "--model" && step.command == "validate"))
        reader.refuse("options", "found " + option + ", which the batch gives itself (a model by the key \"model\")");
}

std::vector<std::string> needs_of(ObjectReader& reader, const BatchStep& step, const std::vector<BatchStep>& earlier) {
  std::vector<std::string> needs = texts(reader, "needs");
  for (const std::string& need : needs)
    if (std::ranges::find(earlier, need, &BatchStep::name) == earlier.end())
      reader.refuse("needs", "found \"" + need + "\", which is no earlier step; name steps that stand above");
  const auto before = commands_before().find(step.command);
  if (reader.has("needs") || before == commands_before().end()) return needs;
  for (const BatchStep& other : earlier)
    if (std::ranges::find(before->second, other.command) != before->second.end() &&
        (step.command == "report" || other.command == "develop" || other.model == step.model))
      needs.push_back(other.name);
  return needs;
}

BatchStep read_step(ObjectReader& reader, const std::vector<BatchStep>& earlier) {
  BatchStep step;
  step.command =
      reader.choice("do", {"develop", "invert", "report", "cloth", "export", "render", "validate", "reproduce"});
  step.name = reader.has("name") ? reader.text("name") : step.command;
  if (const auto problem = problem_with_name(step.name)) reader.refuse("name", *problem);
  if (std::ranges::find(earlier, step.name, &BatchStep::name) != earlier.end())
    reader.refuse("name", "two steps are called \"" + step.name + "\"; give one another \"name\"");
  if (reader.has("model")) step.model = reader.choice("model", {"thread", "bundle", "fiber", "yarn"});
  if (step.model != "thread" && step.command != "invert" && (step.command != "cloth" || step.model != "bundle"))
    reader.refuse("model", step.command + " takes no " + step.model + " here");
  step.options = texts(reader, "options");
  check_options(reader, step);
  step.needs = needs_of(reader, step, earlier);
  if (reader.has("cores")) step.cores = reader.integer("cores", 1, 4096);
  if (reader.has("memory_gib")) step.memory_gib = reader.number("memory_gib", 0.1, 1e5);
  if (reader.has("minutes")) step.minutes = reader.number("minutes", 0.1, 1e6);
  reader.finish();
  return step;
}

}  // namespace

const char* name_of(BatchItemKind kind) {
  switch (kind) {
    case session:
      return "session";
    case thread:
      return "thread";
    case scene:
      return "scene";
    case spool:
      return "spool";
    case figure:
      break;
  }
  return "figure";
}

bool is_for(const BatchStep& step, BatchItemKind kind) {
  const std::vector<BatchItemKind>& kinds = commands().at(step.command);
  return std::ranges::find(kinds, kind) != kinds.end();
}

const BatchStep* BatchFile::step(const std::string& name) const {
  const auto found = std::ranges::find(steps, name, &BatchStep::name);
  return found == steps.end() ? nullptr : &*found;
}

BatchFile parse_batch(const json& document, const std::string& source, const fs::path& folder) {
  ObjectReader reader(document, source, "batch");
  BatchFile batch{.source = source, .folder = folder, .document = document};
  if (reader.has("folder")) batch.folder = reader.text("folder");
  batch.document["folder"] = batch.folder.string();
  bool any = false;
  for (const BatchItemKind kind : kBatchItemKinds) {
    const std::string key = std::string(name_of(kind)) + "s";
    batch.names[static_cast<std::size_t>(kind)] = texts(reader, key);
    any = any || !batch.names_of(kind).empty();
  }
  if (!any) reader.refuse("sessions", std::string("found nothing to work on; give ") + kKindsOfItems);
  for (ObjectReader& step : reader.objects("steps")) batch.steps.push_back(read_step(step, batch.steps));
  if (batch.steps.empty()) reader.refuse("steps", "found none; give at least one, such as {\"do\": \"invert\"}");
  if (reader.has("at_once")) batch.at_once = reader.integer("at_once", 1, 100000);
  batch.slurm_options = texts(reader, "slurm");
  reader.finish();
  return batch;
}

BatchFile read_batch(const fs::path& file) {
  return parse_batch(read_json_file(file), file.string(), fs::absolute(file).parent_path());
}

}  // namespace station

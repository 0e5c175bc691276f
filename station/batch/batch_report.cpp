#include "station/batch/batch_report.h"

#include <algorithm>

#include "station/documents/number_text.h"
#include "station/output/html.h"

namespace station {
namespace {

using nlohmann::json;

std::string name_of_problem(const json& problem) {
  return problem.at("task").get<std::string>() + " " +
         (problem.at("state") == "failed" ? "failed"
          : problem.at("state") == "died" ? "died"
                                          : "was stopped");
}

json describe_step(const BatchStep& step, const std::vector<TaskStatus>& states) {
  json described{{"step", step.name}, {"tasks", 0}};
  for (const TaskState state : kTaskStates) described[name_of(state)] = 0;
  double processor_s = 0, seconds = 0, most_s = 0, peak_mib = 0;
  int measured = 0;
  for (const TaskStatus& status : states) {
    if (status.task.step != &step) continue;
    described["tasks"] = described["tasks"].get<int>() + 1;
    json& number = described[name_of(status.state)];
    number = number.get<int>() + 1;
    if (!status.record || !status.record->done) continue;
    ++measured;
    processor_s += status.record->processor_s, seconds += status.record->seconds;
    most_s = std::max(most_s, status.record->seconds), peak_mib = std::max(peak_mib, status.record->peak_mib);
  }
  described["processor_s"] = processor_s;
  described["seconds_mean"] = measured > 0 ? seconds / measured : 0.0;
  described["seconds_most"] = most_s;
  described["peak_mib"] = peak_mib;
  return described;
}

// The states that any step has tasks in.
std::vector<std::string> states_in(const json& description) {
  std::vector<std::string> names;
  for (const TaskState state : kTaskStates)
    for (const json& step : description.at("steps"))
      if (step.at(name_of(state)) > 0) {
        names.emplace_back(name_of(state));
        break;
      }
  return names;
}

std::vector<std::string> head_of(const json& description) {
  std::vector<std::string> cells{"step", "tasks"};
  for (const std::string& state : states_in(description)) cells.push_back(state);
  cells.insert(cells.end(), {"processor", "mean", "longest", "memory"});
  return cells;
}

std::vector<std::string> row_of(const json& description, const json& step) {
  std::vector<std::string> cells{step.at("step"), std::to_string(step.at("tasks").get<int>())};
  for (const std::string& state : states_in(description)) cells.push_back(std::to_string(step.at(state).get<int>()));
  constexpr double kHour_s = 3600;
  const double processor_s = step.at("processor_s");
  cells.push_back(processor_s < kHour_s ? number_text(processor_s, 1) + " s"
                                        : number_text(processor_s / kHour_s, 2) + " h");
  cells.push_back(number_text(step.at("seconds_mean"), 1) + " s");
  cells.push_back(number_text(step.at("seconds_most"), 1) + " s");
  cells.push_back(number_text(step.at("peak_mib"), 0) + " MiB");
  return cells;
}

}  // namespace

json describe_batch(const BatchWork& work, const std::vector<TaskStatus>& states) {
  json description{{"folder", work.folder.string()}, {"steps", json::array()}, {"problems", json::array()}};
  for (const BatchStep& step : work.plan.steps) description["steps"].push_back(describe_step(step, states));
  for (const TaskStatus& status : states)
    if (status.state == TaskState::failed || status.state == TaskState::died)
      description["problems"].push_back({{"task", name_of(status.task)},
                                         {"state", name_of(status.state)},
                                         {"why", status.why},
                                         {"log", log_of(task_folder(work, status.task)).string()}});
  return description;
}

std::string batch_text(const json& description) {
  std::vector<std::vector<std::string>> rows{head_of(description)};
  for (const json& step : description.at("steps")) rows.push_back(row_of(description, step));
  std::string text;
  for (const auto& row : rows) {
    for (std::size_t i = 0; i < row.size(); ++i) {
      std::size_t width = 0;
      for (const auto& other : rows) width = std::max(width, other[i].size());
      const std::string blank(width - row[i].size(), ' ');
      text += (i == 0 ? row[i] + blank : "  " + blank + row[i]);
    }
    text += "\n";
  }
  for (const json& problem : description.at("problems"))
    text += name_of_problem(problem) + ": " + problem.at("why").get<std::string>() + "\n  " +
            problem.at("log").get<std::string>() + "\n";
  return text;
}

std::string batch_page(const json& description) {
  const auto row = [](const std::vector<std::string>& cells, const char* tag) {
    std::string text = "<tr>";
    for (const std::string& cell : cells) text += std::string("<") + tag + ">" + escaped(cell) + "</" + tag + ">";
    return text + "</tr>";
  };
  std::string body = "<table>" + row(head_of(description), "th");
  for (const json& step : description.at("steps")) body += row(row_of(description, step), "td");
  body += "</table>";
  if (!description.at("problems").empty()) body += "<h2>What failed</h2>";
  for (const json& problem : description.at("problems"))
    body += "<p><b>" + escaped(name_of_problem(problem)) + "</b>: " + escaped(problem.at("why")) + "<br><small>" +
            escaped(problem.at("log")) + "</small></p>";
  return html_page("Batch " + description.at("folder").get<std::string>(), body);
}

}  // namespace station

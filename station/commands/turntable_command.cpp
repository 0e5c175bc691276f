#include <algorithm>
#include <iomanip>
#include <iostream>
#include <sstream>

#include "rig/turntables/grbl_settings.h"
#include "station/bench/turntable_set_up.h"
#include "station/commands/commands.h"

namespace station {
namespace {

struct TurntableArguments {
  std::string rig;
  SetUpRequest request;
  bool json = false;
};

// The lines to type for what differs; empty: nothing does.
std::string lines_to_type(const SetUpReport& report) {
  std::string lines;
  for (const SetUpRow& row : report.rows)
    if (row.needed) lines += (lines.empty() ? "" : ", ") + rig::grbl_setting_line(row.number, *row.needed);
  return lines;
}

void print_table(const SetUpReport& report) {
  std::cout << report.firmware << "\n";
  std::size_t width = 0;
  for (const SetUpRow& row : report.rows) width = std::max(width, row.meaning.size());
  for (const SetUpRow& row : report.rows) {
    std::ostringstream line;
    line << (row.after    ? "  written  "
             : row.needed ? "  DIFFERS  "
                          : "  right    ")
         << std::left << std::setw(6) << "$" + std::to_string(row.number) << std::setw(static_cast<int>(width) + 2)
         << row.meaning << rig::grbl_number(row.before);
    if (row.after) line << " -> " << rig::grbl_number(*row.after);
    if (!row.expected.empty()) line << "  (needed: " << row.expected << ")";
    std::cout << line.str() << "\n";
  }
}

void print_advice(const SetUpReport& report, const SetUpRequest& request) {
  const std::string lines = lines_to_type(report);
  const bool changed = std::ranges::any_of(report.rows, [](const SetUpRow& row) { return row.after.has_value(); });
  if (!request.back_up.empty())
    std::cout << "the former settings are in " << request.back_up.string() << "; --restore puts them back\n";
  if (!changed && lines.empty()) std::cout << "nothing had to be changed\n";
  if (!changed && !lines.empty())
    std::cout << "nothing was changed; \"--write --back-up FILE\" writes what differs, or type: " << lines << "\n";
  if (!report.homing_problem.empty()) std::cout << "homing: " << report.homing_problem << "\n";
}

void print_json(const SetUpReport& report) {
  nlohmann::json rows = nlohmann::json::array();
  for (const SetUpRow& row : report.rows) {
    nlohmann::json entry = {{"number", row.number},
                            {"meaning", row.meaning},
                            {"before", row.before},
                            {"expected", row.expected},
                            {"right", !row.needed}};
    if (row.needed) entry["needed"] = *row.needed;
    if (row.after) entry["after"] = *row.after;
    rows.push_back(entry);
  }
  std::cout << nlohmann::json{{"firmware", report.firmware},
                              {"settings", rows},
                              {"homing_problem", report.homing_problem}}
                   .dump()
            << "\n";
}

}  // namespace

void add_turntable_command(CLI::App& app) {
  CLI::App* turntable = app.add_subcommand("turntable", "the turntable's motor controller");
  turntable->require_subcommand(1);
  CLI::App* command =
      turntable->add_subcommand("set-up", "a GRBL controller's settings beside those that the rig file needs");
  auto arguments = std::make_shared<TurntableArguments>();
  command->add_option("--rig", arguments->rig, "rig file")->required();
  command->add_flag("--write", arguments->request.write, "write the settings that differ, and read them back");
  command->add_option("--back-up", arguments->request.back_up, "new file for the former settings; goes with --write");
  command->add_option("--restore", arguments->request.restore, "put the settings of a back-up back");
  command->add_flag("--json", arguments->json, "as JSON, for machines");
  command->callback([arguments] {
    const SetUpReport report = set_up_turntable(read_rig(arguments->rig), arguments->request);
    if (arguments->json) return print_json(report);
    print_table(report);
    print_advice(report, arguments->request);
  });
}

}  // namespace station

#include <iostream>
#include <nlohmann/json.hpp>

#include "station/commands/commands.h"
#include "station/thread/report/session_report.h"

namespace station {

void add_report_command(CLI::App& app) {
  auto session = std::make_shared<std::string>();
  CLI::App* command = app.add_subcommand("report", "write a session's report.html");
  command->add_option("session", *session, "session folder")->required();
  auto json = std::make_shared<bool>(false);
  command->add_flag("--json", *json, "as JSON, for machines");
  command->callback([session, json] {
    const std::string report = write_session_report(*session).string();
    if (*json)
      std::cout << nlohmann::json{{"report", report}}.dump() << "\n";
    else
      std::cout << "report: " << report << "\n";
  });
}

}  // namespace station

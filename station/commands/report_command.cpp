#include <iostream>

#include "station/commands/commands.h"
#include "station/report/session_report.h"

namespace station {

void add_report_command(CLI::App& app) {
  auto session = std::make_shared<std::string>();
  CLI::App* command = app.add_subcommand("report", "write a session's report.html");
  command->add_option("session", *session, "session folder")->required();
  command->callback([session] { std::cout << "report: " << write_session_report(*session).string() << "\n"; });
}

}  // namespace station

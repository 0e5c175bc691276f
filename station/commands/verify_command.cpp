#include <iostream>
#include <stdexcept>

#include "station/commands/commands.h"
#include "station/session/record/verify.h"

namespace station {
namespace {

void print(const std::string& session, const VerifyReport& report, bool json) {
  if (json) {
    std::cout << nlohmann::json{{"session", session},          {"sound", report.sound()},
                                {"complete", report.complete}, {"state", state_name(report.state)},
                                {"files", report.files},       {"pictures", report.pictures},
                                {"views", report.views},       {"views_planned", report.views_planned},
                                {"problems", report.problems}}
                     .dump()
              << "\n";
    return;
  }
  for (const std::string& problem : report.problems) std::cout << problem << "\n";
  std::cout << report.files << " files hashed, " << report.views << " of " << report.views_planned << " views, "
            << state_name(report.state) << ", "
            << (report.sound() ? "everything as recorded" : std::to_string(report.problems.size()) + " problem(s)")
            << "\n";
}

}  // namespace

void add_verify_command(CLI::App& app) {
  auto session = std::make_shared<std::string>();
  auto json = std::make_shared<bool>(false);
  CLI::App* command = app.add_subcommand("verify", "re-hash everything in a session and name what differs");
  command->add_option("session", *session, "session folder")->required();
  command->add_flag("--json", *json, "as JSON, for machines");
  command->callback([session, json] {
    const VerifyReport report = verify_session(*session);
    print(*session, report, *json);
    if (!report.sound())
      throw std::runtime_error("session " + *session + " does not verify: " + report.problems.front());
  });
}

}  // namespace station

#include "station/commands/commands.h"
#include "station/serve/serve.h"

namespace station {

void add_serve_command(CLI::App& app) {
  auto request = std::make_shared<ServeRequest>();
  CLI::App* command = app.add_subcommand("serve", "the technician's page, for a browser on this computer");
  command->add_option("--rig", request->rig, "rig file")->required();
  command
      ->add_option("--workspace", request->workspace, "folder of calibrations, spools, sessions and library; is made")
      ->required();
  command->add_option("--port", request->port, "0: a free one")->capture_default_str();
  command->add_flag("--lan", request->lan, "answer other computers too; needs --token");
  command->add_option("--token", request->token, "at least 16 characters, without which nobody is answered");
  command->add_option("--host", request->hosts,
                      "with --lan: names under which this computer is asked, like bench-3.lab");
  command->callback([request] { serve(*request); });
}

}  // namespace station

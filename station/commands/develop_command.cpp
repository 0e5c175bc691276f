#include <iostream>

#include "station/commands/commands.h"
#include "station/commands/output_options.h"
#include "station/session/develop/develop_session.h"

namespace station {

void add_develop_command(CLI::App& app) {
  struct DevelopArguments {
    std::string session;
    OutputOptions output;
  };
  auto arguments = std::make_shared<DevelopArguments>();
  CLI::App* command = app.add_subcommand("develop", "raw pictures to linear views and masks");
  command->add_option("session", arguments->session, "session folder")->required();
  arguments->output.add_to(*command);
  command->callback([arguments] {
    const DevelopedViews developed = develop_session(arguments->session, arguments->output.progress_style());
    if (arguments->output.json)
      std::cout << to_json(developed).dump() << "\n";
    else if (!arguments->output.quiet)
      std::cout << describe(developed);
  });
}

}  // namespace station

#include "station/commands/commands.h"
#include "station/commands/output_options.h"
#include "station/session/import_session.h"

namespace station {

void add_import_command(CLI::App& app) {
  struct ImportArguments {
    std::string list;
    CaptureRequest request;
    OutputOptions output;
  };
  auto arguments = std::make_shared<ImportArguments>();
  CLI::App* command = app.add_subcommand("import", "a session from pictures taken by hand");
  command->add_option("--views", arguments->list, "list of the pictures and what they show (import file)")->required();
  command->add_option("--out", arguments->request.session, "session folder")->required();
  arguments->output.add_to(*command);
  command->callback([arguments] {
    arguments->request.progress_style = arguments->output.progress_style();
    import_session(arguments->list, arguments->request);
  });
}

}  // namespace station

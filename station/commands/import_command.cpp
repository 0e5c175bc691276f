#include "station/commands/commands.h"
#include "station/commands/output_options.h"
#include "station/session/import_measured.h"
#include "station/session/import_session.h"

namespace station {

void add_import_command(CLI::App& app) {
  struct ImportArguments {
    std::string list, measured;
    CaptureRequest request;
    OutputOptions output;
  };
  auto arguments = std::make_shared<ImportArguments>();
  CLI::App* command =
      app.add_subcommand("import", "a session from pictures taken by hand, or from views that another lab measured");
  CLI::Option* views =
      command->add_option("--views", arguments->list, "list of the pictures and what they show (import file)");
  command
      ->add_option("--measured", arguments->measured,
                   "another lab's views: linear pictures (EXR, TIFF) and a table of directions (measurement file)")
      ->excludes(views);
  command->add_option("--out", arguments->request.session, "session folder")->required();
  arguments->output.add_to(*command);
  command->callback([arguments] {
    arguments->request.progress_style = arguments->output.progress_style();
    if (arguments->list.empty() == arguments->measured.empty())
      throw std::runtime_error(
          "nothing to import was given; give --views with an import file, or --measured with a measurement file");
    if (!arguments->measured.empty())
      import_measured(arguments->measured, arguments->request.session, arguments->request.progress_style);
    else
      import_session(arguments->list, arguments->request);
  });
}

}  // namespace station

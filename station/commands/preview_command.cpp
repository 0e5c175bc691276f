#include <iostream>

#include "station/bench/live_view.h"
#include "station/commands/commands.h"
#include "station/commands/output_options.h"

namespace station {

void add_preview_command(CLI::App& app) {
  struct PreviewArguments {
    LiveViewRequest request;
    OutputOptions output;
  };
  auto arguments = std::make_shared<PreviewArguments>();
  CLI::App* command =
      turns_platform(app.add_subcommand("preview", "the camera's live view, frame after frame, in a JPEG file"));
  command->add_option("--rig", arguments->request.rig, "rig file")->required();
  command->add_option("--out", arguments->request.out, "JPEG file, replaced by each frame")->required();
  command->add_option("--frames", arguments->request.frames, "end after so many; ctrl-C ends it too")
      ->check(CLI::Range(1, 1000000))
      ->capture_default_str();
  arguments->output.add_to(*command);
  command->callback([arguments] {
    arguments->request.progress_style = arguments->output.progress_style();
    const auto person = asked_person(arguments->output.json);
    arguments->request.asked = person.get();
    const int frames = live_view(arguments->request);
    if (arguments->output.json)
      std::cout << nlohmann::json{{"frames", frames}}.dump() << "\n";
    else if (!arguments->output.quiet)
      std::cout << frames << " frames, the last in " << arguments->request.out.string() << "\n";
  });
}

}  // namespace station

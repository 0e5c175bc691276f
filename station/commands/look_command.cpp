#include <unistd.h>

#include <filesystem>

#include "station/cloth/preview/cloth_look.h"
#include "station/cloth/preview/cloth_preview.h"
#include "station/commands/commands.h"
#include "station/commands/output_options.h"
#include "station/commands/weave_options.h"

namespace station {

void add_look_command(CLI::App& app) {
  struct LookArguments {
    ClothLookRequest request;
    std::filesystem::path of;
    OutputOptions output;
  };
  auto arguments = std::make_shared<LookArguments>();
  ClothLookRequest& request = arguments->request;
  CLI::App* command =
      app.add_subcommand("look", "cloth in a picture that gets better, turned by lines on standard input");
  or_ready("threads",
           command->add_option("thread", arguments->of, "thread or bundle file of the warp, or a ready thread's name"))
      ->required();
  add_weave_options(*command, request.cloth);
  command->add_option("--shape", request.shape, "what the cloth is made into")
      ->check(CLI::IsMember(cloth_shapes()))
      ->capture_default_str();
  command->add_option("--spp", request.samples_per_pixel, "samples per pixel of the best picture")
      ->check(CLI::Range(1, 1 << 16))
      ->capture_default_str();
  command->add_option("--size", request.size_px, "the longer side of the picture in pixels; a screen's without it")
      ->check(CLI::Range(16, 4096));
  command->add_option("--out", request.cloth.out, "folder for look.png and for what the cloth is made of")->required();
  arguments->output.add_to(*command);
  command->callback([arguments] {
    ClothLookRequest& asked = arguments->request;
    constexpr int kPolitely = 4;  // the bench goes first, but somebody looks at this
    [[maybe_unused]] const int politeness = nice(kPolitely);
    asked.input = STDIN_FILENO;
    asked.progress_style = arguments->output.progress_style();
    weave_thread_of(asked.cloth, arguments->of, "thread");
    look_at_cloth(asked);
  });
}

}  // namespace station

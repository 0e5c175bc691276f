#include <iostream>

#include "station/commands/commands.h"
#include "station/commands/output_options.h"
#include "station/render_scene.h"

namespace station {

void add_render_command(CLI::App& app) {
  struct Arguments {
    RenderRequest request;
    bool time = false;
    OutputOptions output;
  };
  auto arguments = std::make_shared<Arguments>();
  RenderRequest& request = arguments->request;
  CLI::App* command = app.add_subcommand("render", "a scene of cloth to a picture");
  command->add_option("scene", request.scene, "scene file")->required();
  command->add_option("--out", request.out, "picture to write: .exr (linear) or .png (display)")->required();
  command->add_option("--spp", request.samples_per_pixel, "samples per pixel")->check(CLI::Range(1, 1 << 20));
  command->add_option("--seed", request.seed, "another number gives another noise")->capture_default_str();
  command->add_option("--threads", request.threads, "processor threads, 0 for all")->check(CLI::Range(0, 4096));
  command->add_option("--exposure", request.exposure, "PNG: radiance times this is shown")
      ->check(CLI::PositiveNumber);
  command->add_flag("--time", arguments->time, "print how long it took");
  arguments->output.add_to(*command);
  command->callback([arguments] {
    arguments->request.progress = arguments->output.progress_style();
    const RenderReport report = render_scene(arguments->request);
    if (arguments->output.json)
      std::cout << to_json(report).dump() << "\n";
    else if (arguments->time)
      std::cout << describe_times(report);
  });
}

}  // namespace station

#include <iostream>

#include "station/commands/commands.h"
#include "station/commands/output_options.h"
#include "station/render_scene.h"

namespace station {

void add_render_command(CLI::App& app) {
  struct Arguments {
    RenderRequest request;
    bool time = false;
    std::string noise;
    OutputOptions output;
  };
  auto arguments = std::make_shared<Arguments>();
  RenderRequest& request = arguments->request;
  CLI::App* command = app.add_subcommand("render", "a scene of cloth to a picture");
  command->add_option("scene", request.scene, "scene file")->required();
  command->add_option("--out", request.out, "picture to write: .exr (linear) or .png (display)")->required();
  command->add_option("--spp", request.samples_per_pixel, "samples per pixel")->check(CLI::Range(1, 1 << 20));
  command
      ->add_option("--noise", arguments->noise,
                   "samples where they are needed, until the noise is this share of the brightness (1%) or --spp is "
                   "reached (4096 when left out)")
      ->check([](const std::string& text) { return parse_noise(text) ? "" : "give 0.01% to 100%"; });
  command->add_option("--seed", request.seed, "another number gives another noise")->capture_default_str();
  command->add_option("--threads", request.threads, "processor threads, 0 for all")->check(CLI::Range(0, 4096));
  command->add_option("--exposure", request.exposure, "PNG: radiance times this is shown")
      ->check(CLI::PositiveNumber);
  command->add_flag("--layers", request.layers,
                    "EXR: albedo, normal, depth, cover, thread and yarn of what each pixel shows, as channels");
  command->add_flag("--half", request.half, "EXR: colours in 16 bit");
  command->add_flag("--fresh", request.fresh, "begin again where an interrupted rendering left a checkpoint");
  command->add_flag("--time", arguments->time, "print how long it took, and how noisy the picture is");
  arguments->output.add_to(*command);
  command->callback([arguments] {
    arguments->request.noise = parse_noise(arguments->noise).value_or(0);
    arguments->request.progress = arguments->output.progress_style();
    const RenderReport report = render_scene(arguments->request);
    if (arguments->output.json)
      std::cout << to_json(report).dump() << "\n";
    else if (arguments->time)
      std::cout << describe_times(report) << describe_noise(report);
  });
}

}  // namespace station

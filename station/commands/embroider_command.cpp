#include <iostream>
#include <nlohmann/json.hpp>

#include "station/commands/commands.h"
#include "station/commands/output_options.h"
#include "station/embroider/embroider_motif.h"

namespace station {

void add_embroider_command(CLI::App& app) {
  struct Arguments {
    EmbroiderRequest request;
    std::vector<std::string> colours;
    std::string ground;
    OutputOptions output;
  };
  auto arguments = std::make_shared<Arguments>();
  EmbroiderRequest& request = arguments->request;
  CLI::App* command = app.add_subcommand("embroider", "a machine embroidery motif in a digitized thread");
  command->add_option("motif", request.motif, "Tajima .dst, Brother .pes or line art as .svg")->required();
  command->add_option("--thread", request.thread, "thread file; each colour changes its absorption alone")
      ->required();
  command->add_option("--out", request.out, "picture: .exr (linear) or .png (display)")->required();
  command->add_option("--colour", arguments->colours,
                      "colours of the motif's threads in the order of sewing, like #c01830; without it the file's");
  command->add_option("--ground", arguments->ground, "colour of the cloth, like #ece8e4");
  command->add_option("--diameter", request.diameter_mm, "of the thread as it is sewn, mm")
      ->check(CLI::Range(0.02, 5.0))
      ->capture_default_str();
  command->add_option("--px-per-mm", request.pixels_per_mm, "pixels per millimetre")
      ->check(CLI::Range(0.1, 1000.0))
      ->capture_default_str();
  command->add_option("--spp", request.samples_per_pixel, "samples per pixel")
      ->check(CLI::Range(1, 1 << 20))
      ->capture_default_str();
  command->add_option("--seed", request.seed, "of the paths")->capture_default_str();
  arguments->output.add_to(*command);
  command->callback([arguments] {
    EmbroiderRequest& asked = arguments->request;
    for (const std::string& colour : arguments->colours) asked.colours.push_back(parse_colour(colour));
    if (!arguments->ground.empty()) asked.ground = parse_colour(arguments->ground);
    asked.progress_style = arguments->output.progress_style();
    const Embroidery embroidery = embroider(asked);
    if (arguments->output.json)
      std::cout << to_json(embroidery).dump() << "\n";
    else if (!arguments->output.quiet)
      std::cout << describe(embroidery);
  });
}

}  // namespace station

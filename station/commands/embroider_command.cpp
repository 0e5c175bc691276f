#include <iostream>
#include <nlohmann/json.hpp>

#include "station/cloth/embroider_motif.h"
#include "station/cloth/render/render_scene.h"
#include "station/commands/commands.h"
#include "station/commands/output_options.h"
#include "station/commands/ready_name.h"

namespace station {

void add_embroider_command(CLI::App& app) {
  struct EmbroiderArguments {
    EmbroiderRequest request;
    std::vector<std::string> colours;
    std::string ground;
    std::vector<double> at_mm;
    OutputOptions output;
  };
  auto arguments = std::make_shared<EmbroiderArguments>();
  EmbroiderRequest& request = arguments->request;
  CLI::App* command = app.add_subcommand("embroider", "a machine embroidery motif in a digitized thread");
  command->add_option("motif", request.motif, "Tajima .dst, Brother .pes or line art as .svg")->required();
  or_ready("threads",
           command->add_option("--thread", request.thread,
                               "thread file or a ready one's name; each colour changes its absorption alone"))
      ->required();
  command->add_option("--out", request.out, "picture: .exr (linear) or .png (display)")->required();
  command->add_option(
      "--colour", arguments->colours,
      "colours of the motif's threads in the order of sewing, like #c01830, crimson or \"lab(40 60 30)\"; "
      "without it the file's");
  command->add_option("--ground", arguments->ground, "colour of the cloth, likewise");
  command->add_option("--diameter", request.diameter_mm, "of the thread as it is sewn, mm")
      ->check(CLI::Range(0.02, 5.0))
      ->capture_default_str();
  CLI::Option* pixels = command->add_option("--px-per-mm", request.pixels_per_mm, "pixels per millimetre")
                            ->check(CLI::Range(0.1, 1000.0))
                            ->capture_default_str();
  CLI::Option* scene =
      or_ready("scenes",
               command->add_option("--scene", request.scene,
                                   "sewn on a cloth of this scene, a file or a ready one's name, and rendered "
                                   "as it says; the scene with the embroidery is written beside the picture"))
          ->excludes(pixels);
  command->add_option("--cloth", request.cloth, "which of the scene's cloths, from 0")
      ->check(CLI::Range(0, 1 << 20))
      ->needs(scene)
      ->capture_default_str();
  command->add_option("--at", arguments->at_mm, "where the motif's middle lies in the cloth, mm; else in its middle")
      ->expected(2)
      ->needs(scene);
  command->add_option("--turn", request.turn_deg, "of the motif on the scene's cloth, degrees counter-clockwise")
      ->check(CLI::Range(-360.0, 360.0))
      ->needs(scene);
  command->add_option("--spp", request.samples_per_pixel, "samples per pixel; 64, or the scene's")
      ->check(CLI::Range(1, kMostSamples));
  command->add_flag("--curves-only", request.by_curve_only,
                    "without looking at the motif: each colour as if its stitches were alone");
  command->add_option("--seed", request.seed, "of the paths")->capture_default_str();
  arguments->output.add_to(*command);
  command->callback([arguments] {
    EmbroiderRequest& asked = arguments->request;
    for (const std::string& colour : arguments->colours) asked.colours.push_back(parse_colour(colour));
    if (!arguments->ground.empty()) asked.ground = parse_colour(arguments->ground);
    if (!arguments->at_mm.empty()) asked.at_mm = Eigen::Vector2d(arguments->at_mm[0], arguments->at_mm[1]);
    asked.progress_style = arguments->output.progress_style();
    const Embroidery embroidery = embroider(asked);
    if (arguments->output.json)
      std::cout << to_json(embroidery).dump() << "\n";
    else if (!arguments->output.quiet)
      std::cout << describe(embroidery);
  });
}

}  // namespace station

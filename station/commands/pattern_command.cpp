#include <iostream>
#include <nlohmann/json.hpp>

#include "station/cloth/pattern/jacquard_cloth.h"
#include "station/cloth/pattern/pattern_cloth.h"
#include "station/commands/commands.h"
#include "station/commands/output_options.h"
#include "station/commands/ready_name.h"

namespace station {

void add_pattern_command(CLI::App& app) {
  struct PatternArguments {
    PatternRequest request;
    std::string jacquard_weft;
    bool curves_only = false;
    OutputOptions output;
  };
  auto arguments = std::make_shared<PatternArguments>();
  PatternRequest& request = arguments->request;
  CLI::App* command = app.add_subcommand("pattern", "a picture woven in a digitized thread");
  command->add_option("--image", request.image, "the picture: PNG, JPEG or linear EXR")->required();
  command
      ->add_option("--out", request.out, "folder for the absorption of each crossing, a scene to render and a report")
      ->required();
  CLI::Option* thread = or_ready(
      "threads", command->add_option("--thread", request.thread,
                                     "thread file or a ready one's name; each crossing changes its absorption alone"));
  CLI::Option* draft =
      or_ready("drafts", command->add_option("--draft", request.draft, "draft of the cloth, or a ready one's name"))
          ->needs(thread);
  thread->needs(draft);
  CLI::Option* scene =
      or_ready("scenes",
               command->add_option("--scene", request.scene,
                                   "a scene, or a ready one's name, whose cloth shows the picture, over and over"))
          ->excludes(thread)
          ->excludes(draft);
  command->add_option("--cloth", request.cloth, "which of the scene's cloths, from 0")
      ->check(CLI::Range(0, 1 << 20))
      ->needs(scene)
      ->capture_default_str();
  command->add_option("--ends", request.ends, "warp yarns across the picture; without it one for each of its pixels")
      ->check(CLI::Range(1, 1 << 20));
  command->add_option("--exposure", request.brightness, "brightness of the picture, 1 = as it is")
      ->check(CLI::Range(1e-3, 1e3))
      ->capture_default_str();
  CLI::Option* as_it_is =
      command->add_flag("!--as-it-is", request.within_gamut,
                        "colours as the picture has them; without it its black to white is brought to the darkest and "
                        "the brightest that the cloth can show");
  CLI::Option* curves_only = command->add_flag("--curves-only", arguments->curves_only,
                                               "without refinement: each crossing as if all cloth had its colour");
  CLI::Option* jacquard =
      or_ready("threads", command->add_option("--jacquard", arguments->jacquard_weft,
                                              "two colours by structure alone: weft of this thread, warp of --thread, "
                                              "their own colours; of the draft only yarns and sett are taken"))
          ->needs(thread);
  curves_only->excludes(jacquard);
  as_it_is->excludes(jacquard);
  command->add_option("--seed", request.seed, "of the paths")->capture_default_str();
  arguments->output.add_to(*command);
  command->callback([arguments] {
    PatternRequest& asked = arguments->request;
    if (arguments->curves_only) asked.steps = 0;
    asked.progress_style = arguments->output.progress_style();
    const auto print = [&](const auto& made) {
      if (arguments->output.json)
        std::cout << to_json(made).dump() << "\n";
      else if (!arguments->output.quiet)
        std::cout << describe(made);
    };
    if (arguments->jacquard_weft.empty())
      print(weave_pattern(asked));
    else
      print(weave_jacquard({.image = asked.image,
                            .out = asked.out,
                            .warp_thread = asked.thread,
                            .weft_thread = arguments->jacquard_weft,
                            .draft = asked.draft,
                            .ends = asked.ends,
                            .brightness = asked.brightness,
                            .seed = asked.seed,
                            .progress_style = asked.progress_style}));
  });
}

}  // namespace station

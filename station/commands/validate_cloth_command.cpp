#include <iostream>
#include <nlohmann/json.hpp>

#include "station/commands/commands.h"
#include "station/commands/output_options.h"
#include "station/documents/thread_file.h"
#include "station/thread/invert/fit_document.h"
#include "station/thread/validate/validate_cloth.h"

namespace station {

void add_validate_cloth_command(CLI::App& app) {
  struct ValidateClothArguments {
    ValidateClothRequest request;
    OutputOptions output;
  };
  auto arguments = std::make_shared<ValidateClothArguments>();
  ValidateClothRequest& request = arguments->request;
  CLI::App* command = app.add_subcommand(
      "validate-cloth", "predict cloth from simulated spools and compare it with cloth of their fibers");
  command->add_option("--rig", request.rig, "rig file with a simulation part: lens, lamps and sensor")->required();
  command->add_option("--warp", request.warps, "spool files with simulated fibers, one or more")->required();
  command->add_option("--weft", request.weft, "spool file with simulated fibers")->required();
  command->add_option("--draft", request.drafts, "draft files, one or more; all ends are warp, all picks weft")
      ->required();
  command->add_option("--out", request.out, "folder of photographs, pictures and results")->required();
  command
      ->add_option("--model", request.models, "models to fit; thread, fiber and yarn (a reconstruction) without this")
      ->transform(CLI::CheckedTransformer(names_of_models()));
  command->add_flag("--true-fibers", request.true_fibers,
                    "predict with the spools' own fibers as bundles, too: what is not the fit's error");
  command->add_option("--exit", request.exit, "where light leaves the thread, in the thread model's fits and pictures")
      ->transform(CLI::CheckedTransformer(thread_exits()));
  command
      ->add_option("--paths", request.paths_per_block,
                   "light paths per block in the fits, one number a round; without this each model's own")
      ->check(CLI::Range(1, 100000));
  command
      ->add_option("--spp", request.samples_per_pixel, "samples per pixel of each of the two renderings of a picture")
      ->check(CLI::Range(1, 65536))
      ->capture_default_str();
  command
      ->add_option("--photograph-spp", request.photograph_samples,
                   "samples per pixel of each of the two photographs of a spool's view")
      ->check(CLI::Range(1, 65536))
      ->capture_default_str();
  command->add_option("--width", request.width_px, "pixels across; the picture is 4 : 3")
      ->check(CLI::Range(64, 8192))
      ->capture_default_str();
  command->add_option("--seed", request.seed, "of photographs, fits and renderings")->capture_default_str();
  arguments->output.add_to(*command);
  command->callback([arguments] {
    arguments->request.height_px = arguments->request.width_px * 3 / 4;
    arguments->request.progress_style = arguments->output.progress_style();
    const std::vector<PredictedSample> samples = validate_cloth(arguments->request);
    if (arguments->output.json)
      std::cout << to_json(samples).dump() << "\n";
    else
      std::cout << describe(samples);
  });
}

}  // namespace station

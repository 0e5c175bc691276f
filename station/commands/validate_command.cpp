#include <iostream>

#include "station/commands/commands.h"
#include "station/commands/output_options.h"
#include "station/thread/invert/fit_document.h"
#include "station/thread/validate/validate_fits.h"

namespace station {
namespace {

struct ValidateArguments {
  ValidateRequest request;
  std::string calibration;
  OutputOptions output;
};

void run(ValidateArguments& arguments) {
  if (!arguments.calibration.empty()) arguments.request.calibration = arguments.calibration;
  arguments.request.progress_style = arguments.output.progress_style();
  const std::vector<ValidatedSpool> spools = validate_fits(arguments.request);
  if (arguments.output.json)
    std::cout << to_json(spools).dump() << "\n";
  else
    std::cout << describe(spools);
}

}  // namespace

void add_validate_command(CLI::App& app) {
  auto arguments = std::make_shared<ValidateArguments>();
  ValidateRequest& request = arguments->request;
  CLI::App* command = app.add_subcommand("validate", "fit simulated spools of fibers and predict views left out");
  command->add_option("--rig", request.rig, "rig file with a simulation part: lens, lamps and sensor")->required();
  command->add_option("--spool", request.spools, "spool files with simulated fibers, one or more")->required();
  command->add_option("--out", request.out, "folder of photographs and results")->required();
  command
      ->add_option("--model", request.models, "models to fit; thread, fiber and yarn (a reconstruction) without this")
      ->transform(CLI::CheckedTransformer(names_of_models()));
  command->add_option("--folds", request.folds, "how often two views are left out; 0: no such fits")
      ->check(CLI::Range(0, 3));
  command->add_option("--calibration", arguments->calibration,
                      "folder of a calibration of the rig: fit with its geometry and light as well");
  command->add_flag("--solvers", request.solvers, "compare Levenberg-Marquardt and Adam on all views");
  command->add_option("--spp", request.samples_per_pixel, "samples per pixel of each of the two photographs of a view")
      ->check(CLI::Range(1, 65536));
  command->add_option("--seed", request.seed, "of photographs and fits");
  arguments->output.add_to(*command);
  command->callback([arguments] { run(*arguments); });
}

}  // namespace station

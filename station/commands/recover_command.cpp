#include <iostream>

#include "station/commands/commands.h"
#include "station/commands/output_options.h"
#include "station/commands/ready_name.h"
#include "station/thread/validate/recover_thread.h"

namespace station {
namespace {

struct RecoverArguments {
  RecoverRequest request;
  std::vector<std::filesystem::path> threads;
  OutputOptions output;
};

void run(RecoverArguments& arguments) {
  arguments.request.progress_style = arguments.output.progress_style();
  const bool json = arguments.output.json;
  const auto recovered = recover_threads(arguments.request, arguments.threads, [&](const RecoveredThread& one) {
    if (!json) std::cout << describe(one) << std::flush;
  });
  std::cout << (json ? to_json(recovered).dump() + "\n" : table_of(recovered));
}

}  // namespace

void add_recover_command(CLI::App& app) {
  auto arguments = std::make_shared<RecoverArguments>();
  RecoverRequest& request = arguments->request;
  CLI::App* command =
      app.add_subcommand("recover", "fit pictures of a known thread: errors, and predicted against seen deviations");
  command->add_option("--rig", request.rig, "rig file with a simulation part: lens, lamps and sensor")->required();
  command->add_option("--spool", request.spool, "spool file, for its wrapping")->required();
  or_ready("threads", command->add_option("--thread", arguments->threads,
                                          "thread files or ready ones' names: the truth, one after the other"))
      ->required();
  command->add_option("--draws", request.draws, "fits to other draws of the noise; 0: none")
      ->check(CLI::Range(0, 10000));
  command->add_option("--prior", request.fit.prior_weight, "weight of the simulated threads' prior; 0: none")
      ->check(CLI::Range(0.0, 1000.0));
  command->add_option("--paths", request.fit.paths_per_block, "light paths per block, one number a round")
      ->check(CLI::Range(1, 100000));
  command->add_option("--spp", request.samples_per_pixel, "samples per pixel of the photographs")
      ->check(CLI::Range(1, 65536));
  command->add_option("--seed", request.fit.seed, "of photographs, noise and light paths");
  arguments->output.add_to(*command);
  command->callback([arguments] { run(*arguments); });
}

}  // namespace station

#include <iostream>

#include "station/commands/commands.h"
#include "station/commands/output_options.h"
#include "station/thread/scatter/make_prior.h"

namespace station {

void add_scatter_prior_command(CLI::App& scatter) {
  struct ScatterPriorArguments {
    std::filesystem::path out;
    std::uint64_t seed = 1;
    OutputOptions output;
  };
  auto arguments = std::make_shared<ScatterPriorArguments>();
  CLI::App* command = scatter.add_subcommand("prior", "what simulated threads have in common, made again");
  command->add_option("--out", arguments->out, "prior to write (JSON)")->required();
  command->add_option("--seed", arguments->seed, "another number gives other threads")->capture_default_str();
  arguments->output.add_to(*command);
  command->callback([arguments] {
    const nlohmann::json prior = make_prior(arguments->out, arguments->seed, arguments->output.progress_style());
    if (arguments->output.json)
      std::cout << prior.dump() << "\n";
    else if (!arguments->output.quiet)
      std::cout << "prior of " << prior.at("threads") << " threads: " << arguments->out.string() << "\n";
  });
}

}  // namespace station

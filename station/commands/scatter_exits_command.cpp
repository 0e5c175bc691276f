#include <iostream>

#include "station/commands/commands.h"
#include "station/commands/output_options.h"
#include "station/thread/scatter/make_exits.h"

namespace station {

void add_scatter_exits_command(CLI::App& scatter) {
  struct ScatterExitsArguments {
    std::filesystem::path out;
    renderer::ExitOptions options{.seed = 1};
    OutputOptions output;
  };
  auto arguments = std::make_shared<ScatterExitsArguments>();
  CLI::App* command = scatter.add_subcommand("exits", "where light leaves simulated threads, made again");
  command->add_option("--out", arguments->out, "table to write (JSON)")->required();
  command->add_option("--seed", arguments->options.seed, "another number gives other threads")->capture_default_str();
  command
      ->add_option("--configurations", arguments->options.configurations,
                   "arrangements of fibers of each thread; fewer are done sooner and are noisier")
      ->check(CLI::Range(2, 10000))
      ->capture_default_str();
  arguments->output.add_to(*command);
  command->callback([arguments] {
    const nlohmann::json exits = make_exits(arguments->out, arguments->options, arguments->output.progress_style());
    if (arguments->output.json)
      std::cout << exits.dump() << "\n";
    else if (!arguments->output.quiet)
      std::cout << "table of exits: " << arguments->out.string() << "\n";
  });
}

}  // namespace station

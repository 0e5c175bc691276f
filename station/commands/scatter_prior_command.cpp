#include <iostream>

#include "station/commands/commands.h"
#include "station/commands/output_options.h"
#include "station/thread/scatter/make_prior.h"

namespace station {

void add_scatter_prior_command(CLI::App& scatter) {
  struct ScatterPriorArguments {
    std::filesystem::path out;
    renderer::PriorOptions options{.seed = 1};
    std::size_t threads = 0;
    OutputOptions output;
  };
  auto arguments = std::make_shared<ScatterPriorArguments>();
  CLI::App* command = scatter.add_subcommand("prior", "what simulated threads have in common, made again");
  command->add_option("--out", arguments->out, "prior to write (JSON)")->required();
  command->add_option("--seed", arguments->options.seed, "another number gives other threads")->capture_default_str();
  arguments->threads = renderer::thread_library().size();
  command->add_option("--threads", arguments->threads, "so many of the library's first; fewer for a trial")
      ->check(CLI::Range(std::size_t{2}, arguments->threads))
      ->capture_default_str();
  command
      ->add_option("--configurations", arguments->options.configurations,
                   "arrangements of fibers of each thread; fewer are done sooner and are noisier")
      ->check(CLI::Range(2, 10000))
      ->capture_default_str();
  arguments->output.add_to(*command);
  command->callback([arguments] {
    const nlohmann::json prior =
        make_prior(arguments->out, arguments->options, arguments->threads, arguments->output.progress_style());
    if (arguments->output.json)
      std::cout << prior.dump() << "\n";
    else if (!arguments->output.quiet)
      std::cout << "prior of " << prior.at("threads") << " threads: " << arguments->out.string() << "\n";
  });
}

}  // namespace station

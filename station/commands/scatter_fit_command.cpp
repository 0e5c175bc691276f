#include <iostream>

#include "station/commands/commands.h"
#include "station/commands/output_options.h"
#include "station/thread/scatter/fit_distributions.h"

namespace station {

void add_scatter_fit_command(CLI::App& scatter) {
  struct ScatterFitArguments {
    FitRequest request;
    OutputOptions output;
  };
  auto arguments = std::make_shared<ScatterFitArguments>();
  CLI::App* command = scatter.add_subcommand("fit", "thread model and yarn reconstruction to simulated distributions");
  command->add_option("--in", arguments->request.in, "distributions of one thread (CSV of scatter simulate)")
      ->required();
  command->add_option("--out", arguments->request.out, "fits to write (JSON)")->required();
  arguments->output.add_to(*command);
  command->callback([arguments] {
    arguments->request.progress = arguments->output.progress_style();
    const DistributionFits fits = fit_files(arguments->request);
    if (arguments->output.json)
      std::cout << to_json(fits).dump() << "\n";
    else if (!arguments->output.quiet)
      std::cout << error_table(fits) << "fits: " << arguments->request.out.string() << "\n";
  });
}

}  // namespace station

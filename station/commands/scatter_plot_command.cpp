#include <iostream>

#include "station/commands/commands.h"
#include "station/commands/output_options.h"
#include "station/thread/scatter/plot_scattering.h"

namespace station {

void add_scatter_plot_command(CLI::App& scatter) {
  struct ScatterPlotArguments {
    ScatterPlotRequest request;
    OutputOptions output;
  };
  auto arguments = std::make_shared<ScatterPlotArguments>();
  renderer::MultiFiberOptions& options = arguments->request.options;
  CLI::App* command = scatter.add_subcommand("plot", "what many fibers do, simulated and fitted, as pictures");
  command->add_option("--out", arguments->request.out, "folder for the pictures")->required();
  command->add_option("--rays", options.rays, "per configuration")->capture_default_str();
  command->add_option("--configurations", options.configurations, "random threads")->capture_default_str();
  command->add_option("--eta", options.eta, "index of refraction of the fibers")->capture_default_str();
  command->add_option("--seed", options.seed, "another number gives other threads")->capture_default_str();
  command->add_option("--threads", options.threads, "processor threads, 0 for all")->check(CLI::Range(0, 4096));
  arguments->output.add_to(*command);
  command->callback([arguments] {
    arguments->request.progress = arguments->output.progress_style();
    const std::vector<std::filesystem::path> files = plot_scattering(arguments->request);
    nlohmann::json list = nlohmann::json::array();
    for (const std::filesystem::path& file : files) list.push_back(file.string());
    if (arguments->output.json)
      std::cout << list.dump() << "\n";
    else if (!arguments->output.quiet)
      for (const std::filesystem::path& file : files) std::cout << file.string() << "\n";
  });
}

}  // namespace station

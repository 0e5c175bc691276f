#include <iostream>

#include "station/commands/commands.h"
#include "station/commands/output_options.h"
#include "station/documents/degree.h"
#include "station/thread/scatter/simulate.h"

namespace station {

void add_scatter_simulate_command(CLI::App& scatter) {
  struct ScatterSimulateArguments {
    SimulateRequest request;
    double theta_deg = 0;
    std::string placement = "area";
    OutputOptions output;
  };
  auto arguments = std::make_shared<ScatterSimulateArguments>();
  renderer::MultiFiberOptions& options = arguments->request.options;
  CLI::App* command = scatter.add_subcommand("simulate", "light in a thread of many smooth fibers");
  command->add_option("--fiber-radius", options.fiber_radius, "in the unit of the thread's")->capture_default_str();
  command->add_option("--thread-radius", options.thread_radius, "in any unit")->capture_default_str();
  command->add_option("--gap", options.min_gap, "least gap between fibers")->capture_default_str();
  command->add_option("--attempts", options.max_attempts, "to place a fiber, per configuration")->capture_default_str();
  command->add_option("--placement", arguments->placement, "centres uniform over the area or over the radius")
      ->check(CLI::IsMember({"area", "radius"}))
      ->capture_default_str();
  command->add_option("--eta", options.eta, "index of refraction of the fibers")->capture_default_str();
  command->add_option("--absorption", options.sigma_a, "per fiber radius")->capture_default_str();
  command->add_option("--theta", arguments->theta_deg, "inclination in degrees")->capture_default_str();
  command->add_option("--rays", options.rays, "per configuration")->capture_default_str();
  command->add_option("--configurations", options.configurations, "random threads")->capture_default_str();
  command->add_option("--bins", options.bins, "of azimuth")->capture_default_str();
  command->add_option("--seed", options.seed, "another number gives another thread")->capture_default_str();
  command->add_option("--threads", options.threads, "processor threads, 0 for all")->check(CLI::Range(0, 4096));
  command->add_option("--out", arguments->request.out, "distribution to write (CSV)")->required();
  arguments->output.add_to(*command);
  command->callback([arguments] {
    SimulateRequest& request = arguments->request;
    request.options.theta_rad = arguments->theta_deg * kDegree;
    if (arguments->placement == "radius") request.options.placement = renderer::FiberPlacement::radius_uniform;
    request.progress = arguments->output.progress_style();
    const renderer::MultiFiberScattering found = simulate_to_file(request);
    if (arguments->output.json)
      std::cout << to_json(found).dump() << "\n";
    else if (!arguments->output.quiet)
      std::cout << described(found) << "distribution: " << request.out.string() << "\n";
  });
}

}  // namespace station

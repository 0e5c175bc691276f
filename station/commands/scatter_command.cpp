#include "station/commands/commands.h"

namespace station {

void add_scatter_command(CLI::App& app) {
  CLI::App* scatter = app.add_subcommand("scatter", "scattering models of fibers, threads and yarns");
  scatter->require_subcommand(1);
  add_scatter_simulate_command(*scatter);
  add_scatter_fit_command(*scatter);
  add_scatter_eval_command(*scatter);
  add_scatter_plot_command(*scatter);
  add_scatter_prior_command(*scatter);
  add_scatter_exits_command(*scatter);
}

}  // namespace station

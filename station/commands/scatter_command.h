// One function per sub-command of `threadstation scatter` (commands.h says how commands are written).
#pragma once

#include <CLI/CLI.hpp>

namespace station {

void add_scatter_eval_command(CLI::App& scatter);
void add_scatter_fit_command(CLI::App& scatter);
void add_scatter_plot_command(CLI::App& scatter);
void add_scatter_prior_command(CLI::App& scatter);
void add_scatter_simulate_command(CLI::App& scatter);

}  // namespace station

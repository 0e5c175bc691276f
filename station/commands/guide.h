// How the commands are found by who has something to do: their groups in --help, and an example of each.
#pragma once

#include <CLI/CLI.hpp>

namespace station {

// Puts each command into its group and an example below its own --help. The order is that of the work, and examples
// take what those before them made; a test runs them all in that order.
void add_guide(CLI::App& app);

}  // namespace station

// One function per sub-command of `threadstation export` (commands.h says how commands are written).
#pragma once

#include <CLI/CLI.hpp>

namespace station {

void add_export_thread_command(CLI::App& exports);
void add_export_cloth_command(CLI::App& exports);

}  // namespace station

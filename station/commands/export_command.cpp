#include "station/commands/commands.h"

namespace station {

void add_export_command(CLI::App& app) {
  CLI::App* command = app.add_subcommand("export", "cloth and threads for other programs");
  command->require_subcommand(1);
  add_export_cloth_command(*command);
}

}  // namespace station

#include "station/commands/commands.h"

namespace station {

void add_export_command(CLI::App& app) {
  CLI::App* exports = app.add_subcommand("export", "digitized threads and cloth for other programs");
  exports->require_subcommand(1);
  add_export_thread_command(*exports);
  add_export_cloth_command(*exports);
}

}  // namespace station

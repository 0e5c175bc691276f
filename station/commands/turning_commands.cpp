#include <algorithm>
#include <stdexcept>

#include "station/bench/rig_devices.h"
#include "station/commands/commands.h"

namespace station {
namespace {

constexpr const char* kTurns = " (turns the platform)";

bool is_declared(const CLI::App& command) {
  return command.get_description().ends_with(kTurns) ||
         std::ranges::any_of(command.get_subcommands(), [](const CLI::App* part) { return is_declared(*part); });
}

}  // namespace

CLI::App* turns_platform(CLI::App* command) {
  return command->description(command->get_description() + kTurns);
}

void require_declared_turning(const CLI::App& app) {
  if (turntables_opened() > 0 && !is_declared(app))
    throw std::logic_error("this command opened a turntable and is not listed among those that turn the platform");
}

}  // namespace station

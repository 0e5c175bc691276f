#include <iostream>

#include "station/bench/simulate_hardware.h"
#include "station/commands/commands.h"
#include "station/output/interrupt.h"

namespace station {
namespace {

void print(const RigFile& rig, const SimulatedPorts& ports, bool json) {
  nlohmann::json document = nlohmann::json::object();
  if (!ports.turntable.empty())
    document["turntable"] = {{"driver", rig.turntable_driver}, {"line", "pty"}, {"port", ports.turntable}};
  if (!ports.camera.empty()) document["camera"] = {{"driver", "gphoto2"}, {"port", ports.camera}};
  if (json) {
    std::cout << document.dump() << std::endl;
    return;
  }
  for (const auto& [device, how] : document.items())
    std::cout << device << "  " << how["driver"].get<std::string>() << "  " << how["port"].get<std::string>() << "\n";
  std::cout << "Ctrl-C ends" << std::endl;
}

}  // namespace

void add_simulate_hardware_command(CLI::App& app) {
  auto rig = std::make_shared<std::string>();
  auto faults = std::make_shared<std::string>();
  auto json = std::make_shared<bool>(false);
  CLI::App* command =
      app.add_subcommand("simulate-hardware", "start a rig's simulated devices and print their ports, until Ctrl-C");
  command->add_option("--rig", *rig, "rig file with devices that are simulated on a wire")->required();
  command->add_option("--faults", *faults, "fault plan: what goes wrong, and when");
  command->add_flag("--json", *json, "as JSON, for machines");
  command->callback([rig, faults, json] {
    const RigFile file = read_rig(*rig);
    const Faults plan = faults->empty() ? Faults{} : read_faults(*faults);
    watch_interrupts();
    simulate_hardware(
        file, plan, [&](const SimulatedPorts& ports) { print(file, ports, *json); }, interrupted);
  });
}

}  // namespace station

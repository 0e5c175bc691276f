#include <iostream>
#include <nlohmann/json.hpp>

#include "rig/devices/detect.h"
#include "station/commands/commands.h"

namespace station {
namespace {

void print(const std::vector<rig::FoundDevice>& devices, bool json) {
  if (json) {
    nlohmann::json list = nlohmann::json::array();
    for (const rig::FoundDevice& d : devices)
      list.push_back({{"kind", d.kind},
                      {"name", d.name},
                      {"port", d.port},
                      {"usb_id", d.usb_id},
                      {"serial", d.serial},
                      {"believed_to_be", d.believed_to_be},
                      {"by_id", d.by_id},
                      {"by_path", d.by_path},
                      {"recommended", d.recommended}});
    std::cout << list.dump() << "\n";
    return;
  }
  if (devices.empty()) std::cout << "no camera and no serial port found; plug one in and switch it on\n";
  for (const rig::FoundDevice& d : devices) {
    std::cout << d.kind << "  " << d.port << "  " << d.name << (d.serial.empty() ? "" : "  serial " + d.serial) << "  ("
              << d.believed_to_be << ")\n";
    for (const std::string& link : {d.by_id, d.by_path})
      if (!link.empty()) std::cout << "  also " << link << "\n";
    if (!d.recommended.empty()) std::cout << "  in the rig file: \"port\": \"" << d.recommended << "\"\n";
  }
}

}  // namespace

void add_devices_command(CLI::App& app) {
  auto json = std::make_shared<bool>(false);
  CLI::App* command = app.add_subcommand("devices", "list cameras and serial ports, and what each is believed to be");
  command->add_flag("--json", *json, "as JSON, for machines");
  command->callback([json] { print(rig::find_devices(), *json); });
}

}  // namespace station

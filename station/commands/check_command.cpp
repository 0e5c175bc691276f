#include <algorithm>
#include <iomanip>
#include <iostream>
#include <stdexcept>

#include "station/bench/check_rig.h"
#include "station/commands/commands.h"
#include "station/commands/output_options.h"

namespace station {
namespace {

void print_table(const std::vector<DeviceCheck>& checks) {
  std::size_t width = 0;
  for (const DeviceCheck& check : checks)
    for (const rig::ContractRow& row : check.rows) width = std::max(width, row.name.size());
  for (const DeviceCheck& check : checks) {
    std::cout << check.device << "\n";
    for (const rig::ContractRow& row : check.rows)
      std::cout << (row.passed ? "  ok    " : "  FAIL  ") << std::left << std::setw(static_cast<int>(width) + 2)
                << row.name << row.what << "\n";
  }
}

void print_json(const std::vector<DeviceCheck>& checks) {
  nlohmann::json list = nlohmann::json::array();
  for (const DeviceCheck& check : checks) {
    nlohmann::json rows = nlohmann::json::array();
    for (const rig::ContractRow& row : check.rows)
      rows.push_back({{"name", row.name}, {"passed", row.passed}, {"what", row.what}});
    list.push_back({{"device", check.device}, {"passed", rig::all_passed(check.rows)}, {"rows", rows}});
  }
  std::cout << list.dump() << "\n";
}

}  // namespace

void add_check_command(CLI::App& app) {
  auto rig = std::make_shared<std::string>();
  auto calibration = std::make_shared<std::string>();
  auto json = std::make_shared<bool>(false);
  CLI::App* command =
      turns_platform(app.add_subcommand("check", "connect a rig's devices, turn the platform, take test pictures"));
  command->add_option("--rig", *rig, "rig file")->required();
  command->add_option("--calibration", *calibration,
                      "the rig's calibration: takes a test picture too (empty platform, room light on)");
  command->add_flag("--json", *json, "results and questions as JSON, for machines");
  command->callback([rig, calibration, json] {
    const RigFile file = read_rig(*rig);
    std::optional<RigCalibration> calibrated;
    if (!calibration->empty()) calibrated = read_calibration(*calibration);
    const std::vector<DeviceCheck> checks = check_rig(file, calibrated, *asked_person(*json));
    *json ? print_json(checks) : print_table(checks);
    for (const DeviceCheck& check : checks)
      for (const rig::ContractRow& row : check.rows)
        if (!row.passed) throw std::runtime_error("the " + check.device + " failed \"" + row.name + "\": " + row.what);
  });
}

}  // namespace station

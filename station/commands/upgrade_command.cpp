#include <iostream>
#include <nlohmann/json.hpp>

#include "station/commands/commands.h"
#include "station/session/upgrade_files.h"

namespace station {
namespace {

void print(const std::vector<UpgradedFile>& upgraded, bool json) {
  nlohmann::json list = nlohmann::json::array();
  for (const UpgradedFile& one : upgraded) {
    list.push_back({{"file", one.file.string()}, {"copy", one.copy.string()}});
    if (!json) std::cout << one.file.string() << " (as it was: " << one.copy.string() << ")\n";
  }
  if (json)
    std::cout << list.dump() << "\n";
  else if (upgraded.empty())
    std::cout << "everything is of this version already\n";
}

}  // namespace

void add_upgrade_command(CLI::App& app) {
  auto place = std::make_shared<std::string>();
  auto json = std::make_shared<bool>(false);
  CLI::App* command = app.add_subcommand("upgrade", "write files of an earlier threadstation anew; copies are kept");
  command->add_option("place", *place, "file, or folder such as a session")->required();
  command->add_flag("--json", *json, "as JSON, for machines");
  command->callback([place, json] { print(upgrade_files(*place), *json); });
}

}  // namespace station

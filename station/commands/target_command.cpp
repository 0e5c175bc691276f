#include <iostream>

#include "station/bench/print_targets.h"
#include "station/commands/commands.h"

namespace station {
namespace {

struct Arguments {
  std::filesystem::path rig = std::filesystem::path(THREADSTATION_FIXTURES) / "rigs" / "simulated.json", out;
  std::string paper = "a4";
};

void run(const Arguments& arguments) {
  const RigFile rig = read_rig(arguments.rig);
  for (const auto& file : print_targets(rig, arguments.paper == "a4" ? Paper::a4 : Paper::letter, arguments.out))
    std::cout << file.string() << "\n";
}

}  // namespace

void add_target_command(CLI::App& app) {
  auto arguments = std::make_shared<Arguments>();
  CLI::App* command = app.add_subcommand("target", "printable calibration targets (PDF, PNG) and their geometry");
  command->add_option("--out", arguments->out, "folder for the files")->required();
  command->add_option("--paper", arguments->paper, "a4 or letter")->check(CLI::IsMember({"a4", "letter"}));
  command->add_option("--rig", arguments->rig, "rig file with the sizes; the documented example when not given");
  command->callback([arguments] { run(*arguments); });
}

}  // namespace station

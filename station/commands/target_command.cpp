#include <iostream>

#include "station/bench/print_targets.h"
#include "station/commands/commands.h"
#include "station/data/data_folder.h"

namespace station {
namespace {

struct TargetArguments {
  std::filesystem::path rig, out;
  std::string paper = "a4";
};

void run(const TargetArguments& arguments) {
  if (arguments.rig.empty())
    throw CLI::ValidationError(
        "--rig",
        "not given; name the rig file of your bench, whose targets are to be printed. Files to begin with are in " +
            (data_folder_name() / "rigs").string());
  const RigFile rig = read_rig(arguments.rig);
  for (const auto& file : print_targets(rig, arguments.paper == "a4" ? Paper::a4 : Paper::letter, arguments.out))
    std::cout << file.string() << "\n";
}

}  // namespace

void add_target_command(CLI::App& app) {
  auto arguments = std::make_shared<TargetArguments>();
  CLI::App* command = app.add_subcommand("target", "printable calibration targets (PDF, PNG) and their geometry");
  command->add_option("--out", arguments->out, "folder for the files")->required();
  command->add_option("--paper", arguments->paper, "a4 or letter")->check(CLI::IsMember({"a4", "letter"}));
  command->add_option("--rig", arguments->rig, "rig file of the bench that they are for, with their sizes");
  command->callback([arguments] { run(*arguments); });
}

}  // namespace station

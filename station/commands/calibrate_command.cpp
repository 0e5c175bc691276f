#include <iostream>

#include "station/calibrate/calibrate_rig.h"
#include "station/commands/commands.h"
#include "station/commands/output_options.h"
#include "station/documents/gate_list.h"

namespace station {
namespace {

struct Arguments {
  CalibrateRequest request;
  OutputOptions output;
};

void run(Arguments& arguments) {
  arguments.request.progress_style = arguments.output.progress_style();
  const RigCalibration calibration = calibrate_rig(arguments.request);
  if (arguments.output.json)
    std::cout << to_json(calibration).dump() << "\n";
  else if (!arguments.output.quiet)
    std::cout << describe(calibration) << "calibration: " << (arguments.request.out / "calibration.json").string()
              << "\n";
  const std::string failed = failed_gates(all_gates(calibration));
  if (!failed.empty()) throw std::runtime_error("the calibration is written but not good enough: " + failed);
}

}  // namespace

void add_calibrate_command(CLI::App& app) {
  auto arguments = std::make_shared<Arguments>();
  CLI::App* command = app.add_subcommand("calibrate", "calibrate lens, platform, sensor and lamp with the rig");
  command->add_option("--rig", arguments->request.rig, "rig file")->required();
  command
      ->add_option("--out", arguments->request.out,
                   "folder for pictures and calibration.json; an interrupted one goes on")
      ->required();
  command->add_option("--only", arguments->request.only, "take the pictures of this part again")
      ->check(CLI::IsMember({"camera", "platform", "light", "response"}));
  command->add_flag("--solve", arguments->request.solve_only, "take no pictures: solve again from those in --out");
  arguments->output.add_to(*command);
  command->callback([arguments] { run(*arguments); });
}

}  // namespace station

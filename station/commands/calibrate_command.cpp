#include <iostream>
#include <stdexcept>

#include "station/bench/calibrate/calibrate_camera.h"
#include "station/bench/calibrate/calibrate_rig.h"
#include "station/bench/calibrate/error_budget.h"
#include "station/commands/commands.h"
#include "station/commands/output_options.h"
#include "station/documents/gate_list.h"

namespace station {
namespace {

struct CalibrateArguments {
  CalibrateRequest request;
  OutputOptions output;
};

struct CameraArguments {
  CalibrateCameraRequest request;
  OutputOptions output;
};

void run_camera(CameraArguments& arguments) {
  arguments.request.progress_style = arguments.output.progress_style();
  const auto [lens, remarks] = calibrate_camera(arguments.request);
  for (const std::string& remark : remarks) std::cerr << "note: " << remark << "\n";
  if (arguments.output.json)
    std::cout << to_json(lens).dump() << "\n";
  else if (!arguments.output.quiet)
    std::cout << describe(lens.fit) << "lens: " << arguments.request.out.string() << "\n";
  const std::string failed = failed_gates(lens.fit.gates);
  if (!failed.empty() || !lens.fit.converged)
    throw std::runtime_error("this lens is not to be used (" + arguments.request.out.string() + " shows why): " +
                             (lens.fit.converged ? failed : "the fit did not converge; take more pictures"));
}

void add_camera_command(CLI::App& calibrate) {
  auto arguments = std::make_shared<CameraArguments>();
  CLI::App* command = calibrate.add_subcommand("camera", "calibrate a lens from existing pictures of a printed board");
  command->add_option("--images", arguments->request.images, "folder of pictures: JPEG, PNG, TIFF or raw")->required();
  command->add_option("--board", arguments->request.board, "board file: AprilTag grid or chessboard")->required();
  command->add_option("--out", arguments->request.out, "lens file to write; its .cameramodel goes beside it")
      ->required();
  command
      ->add_option("--focal-px", arguments->request.focal_guess_px,
                   "focal length in pixels, good to a factor of two; found from the pictures when not given")
      ->check(CLI::PositiveNumber);
  command
      ->add_option("--distance-mm", arguments->request.working_distance_mm,
                   "where the lens will be used; the pictures' median distance when not given")
      ->check(CLI::PositiveNumber);
  command
      ->add_option("--tape-mm", arguments->request.taped_distance_mm,
                   "typical distance of the board by tape measure: checks the sizes in the board file")
      ->check(CLI::PositiveNumber);
  arguments->output.add_to(*command);
  command->callback([arguments] { run_camera(*arguments); });
}

void run(CalibrateArguments& arguments) {
  const auto person = asked_person(arguments.output.json);
  arguments.request.asked = person.get();
  arguments.request.progress_style = arguments.output.progress_style();
  const RigCalibration calibration = calibrate_rig(arguments.request);
  if (arguments.output.json)
    std::cout << to_json(calibration).dump() << "\n";
  else if (!arguments.output.quiet)
    std::cout << describe(calibration) << describe_budget(calibration)
              << "calibration: " << (arguments.request.out / "calibration.json").string() << "\n";
  const std::string failed = failed_gates(all_gates(calibration));
  if (!failed.empty()) throw std::runtime_error("the calibration is written but not good enough: " + failed);
}

}  // namespace

void add_calibrate_command(CLI::App& app) {
  auto arguments = std::make_shared<CalibrateArguments>();
  CLI::App* command =
      turns_platform(app.add_subcommand("calibrate", "calibrate lens, platform, sensor and lamp with the rig"));
  command->add_option("--rig", arguments->request.rig, "rig file");
  command->add_option("--out", arguments->request.out,
                      "folder for pictures and calibration.json; an interrupted one goes on");
  command->add_option("--live", arguments->request.live,
                      "JPEG of what the camera sees while a target is put down, with the outline where it is wanted");
  command->add_option("--only", arguments->request.only, "take the pictures of this part again")
      ->check(CLI::IsMember({"camera", "platform", "light", "response"}));
  command->add_flag("--solve", arguments->request.solve_only, "take no pictures: solve again from those in --out");
  arguments->output.add_to(*command);
  add_camera_command(*command);
  command->callback([arguments, command] {
    if (!command->get_subcommands().empty()) return;  // `calibrate camera` has options of its own
    if (arguments->request.rig.empty()) throw CLI::RequiredError("--rig");
    if (arguments->request.out.empty()) throw CLI::RequiredError("--out");
    run(*arguments);
  });
}

}  // namespace station

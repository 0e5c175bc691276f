#include <stdexcept>

#include "station/capture_session.h"
#include "station/commands/commands.h"
#include "station/commands/output_options.h"

namespace station {
namespace {

struct Arguments {
  CaptureRequest request;
  bool resume = false;
  OutputOptions output;
};

void run(Arguments& arguments) {
  CaptureRequest& request = arguments.request;
  request.progress_style = arguments.output.progress_style();
  const RunOutcome outcome = arguments.resume
                                 ? resume_session(request.out, request.unattended, request.progress_style)
                                 : capture_session(request);
  if (outcome == RunOutcome::interrupted)
    throw std::runtime_error("capture was interrupted; go on with: threadstation capture --resume --out " +
                             request.out.string());
}

}  // namespace

void add_capture_command(CLI::App& app) {
  auto arguments = std::make_shared<Arguments>();
  CaptureRequest& request = arguments->request;
  CLI::App* command = app.add_subcommand("capture", "photograph a spool in 17 views");
  CLI::Option* rig = command->add_option("--rig", request.rig, "rig file");
  CLI::Option* calibration = command->add_option("--calibration", request.calibration, "folder made by calibrate");
  CLI::Option* spool = command->add_option("--spool", request.spool, "spool file");
  command->add_option("--out", request.out, "session folder")->required();
  command->add_flag("--unattended", request.unattended, "ask nobody; refused when the rig needs a person");
  command->add_flag("--accept-calibration", request.accept_calibration,
                    "use a calibration although it did not pass all its gates");
  CLI::Option* resume =
      command->add_flag("--resume", arguments->resume, "go on with the session in --out; needs nothing else");
  arguments->output.add_to(*command);
  command->callback([=] {
    if (arguments->resume && (rig->count() || calibration->count() || spool->count()))
      throw CLI::ValidationError("--resume", "takes rig, calibration and spool from the session; give only --out");
    if (!resume->count() && !(rig->count() && calibration->count() && spool->count()))
      throw CLI::RequiredError("--rig, --calibration and --spool (or --resume)");
    run(*arguments);
  });
}

}  // namespace station

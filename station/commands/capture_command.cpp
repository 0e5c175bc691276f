#include <iostream>
#include <stdexcept>

#include "station/commands/commands.h"
#include "station/commands/output_options.h"
#include "station/session/capture_session.h"
#include "station/session/spool_queue.h"

namespace station {
namespace {

struct CaptureArguments {
  CaptureRequest request;
  bool unattended = false, resume = false;
  std::string queue, sample;
  OutputOptions output;
};

// False ends the queue.
bool ask_for_spool(const QueuedSpool& spool, rig::AskedPerson& asked) {
  asked.prepare({{"step", nullptr}, {"of", nullptr}, {"arrangement", nullptr}}, "");  // the spool's before
  return asked.ask({.text = "Next spool: " + spool.session +
                            (spool.sample.name.empty() ? "" : " (" + spool.sample.name + ")") +
                            (spool.sample.note.empty() ? "" : ", " + spool.sample.note) + "\nPut it on the holder."}) ==
         rig::kDone;
}

std::string outcome_text(const QueueResult& result) {
  switch (result.outcome) {
    case QueueOutcome::captured:
      return "captured";
    case QueueOutcome::resumed:
      return "captured to its end";
    case QueueOutcome::kept:
      return "was complete already";
    case QueueOutcome::failed:
      return "failed: " + result.problem;
    case QueueOutcome::bench_fault:
      return "waits, the bench has a fault: " + result.problem;
    case QueueOutcome::waiting:
      break;
  }
  return "waits";
}

void run_queue(const CaptureArguments& arguments) {
  const CaptureRequest& request = arguments.request;
  std::function<bool(const QueuedSpool&)> next;
  if (request.asked && read_rig(request.new_session->rig).operator_driver == "console")
    next = [&](const QueuedSpool& spool) { return ask_for_spool(spool, *request.asked); };
  std::string first_problem;
  const std::vector<QueueResult> results = capture_queue(arguments.queue, request, next);
  for (const QueueResult& result : results) {
    std::cout << result.spool.session << ": " << outcome_text(result) << "\n";
    if (first_problem.empty() && !result.problem.empty()) first_problem = result.spool.session + ": " + result.problem;
  }
  if (const auto paused = pause_line(results)) throw std::runtime_error(*paused);
  if (!first_problem.empty()) throw std::runtime_error(first_problem + "; the same command goes on from here");
}

void run(CaptureArguments& arguments) {
  CaptureRequest& request = arguments.request;
  request.progress_style = arguments.output.progress_style();
  const auto person = asked_person(arguments.output.json);
  if (!arguments.unattended) request.asked = person.get();
  if (!arguments.queue.empty()) return run_queue(arguments);
  if (!arguments.sample.empty()) request.new_session->sample = read_sample_file(arguments.sample);
  if (arguments.resume) request.new_session.reset();
  const RunState state = capture_session(request);
  if (state != RunState::complete)
    throw std::runtime_error("capture was " + state_name(state) +
                             "; go on with: threadstation capture --resume --out " + request.session.string());
}

}  // namespace

void add_capture_command(CLI::App& app) {
  auto arguments = std::make_shared<CaptureArguments>();
  CaptureRequest& request = arguments->request;
  NewSession& made_of = request.new_session.emplace();
  CLI::App* command = turns_platform(app.add_subcommand("capture", "photograph a spool in 17 views"));
  CLI::Option* rig = command->add_option("--rig", made_of.rig, "rig file");
  CLI::Option* calibration = command->add_option("--calibration", made_of.calibration, "folder made by calibrate");
  CLI::Option* spool = command->add_option("--spool", made_of.spool, "spool file");
  CLI::Option* queue = command->add_option("--queue", arguments->queue,
                                           "table of spools (CSV); --out then is the folder of their sessions");
  command->add_option("--out", request.session, "session folder")->required();
  command->add_option("--plan", made_of.plan, "plan of one's own, from threadstation plan");
  command->add_option("--operator", made_of.person, "who captures; written into the session");
  command->add_option(
      "--sample", arguments->sample,
      "what the lab knows of the spool beside its geometry (barcode, name, lot, material, colour, note; JSON)");
  command->add_flag("--unattended", arguments->unattended, "ask nobody; refused when the rig needs a person");
  command->add_flag("--record", request.record,
                    "keep test pictures and all that the devices say, so that the session can be replayed");
  command->add_flag("--accept-calibration", made_of.accept_calibration,
                    "use a calibration although it did not pass all its gates");
  command->add_flag("--resume", arguments->resume, "go on with the session in --out; needs nothing else");
  CLI::Option* reshoot =
      command->add_option("--reshoot", request.reshoot, "views (1, 2, ...) or steps (by name) to take again; resumes");
  arguments->output.add_to(*command);
  command->callback([=] {
    if (reshoot->count()) arguments->resume = true;
    if (arguments->resume && (rig->count() || calibration->count() || spool->count()))
      throw CLI::ValidationError("--resume", "takes rig, calibration and spool from the session; give only --out");
    if (queue->count() && (arguments->resume || spool->count()))
      throw CLI::ValidationError("--queue",
                                 "names the spools itself and resumes by itself; leave --spool, --resume and "
                                 "--reshoot out");
    if (queue->count() && rig->count() && calibration->count()) return run(*arguments);
    if (!arguments->resume && !(rig->count() && calibration->count() && spool->count()))
      throw CLI::RequiredError("--rig, --calibration and --spool (or --resume)");
    run(*arguments);
  });
}

}  // namespace station

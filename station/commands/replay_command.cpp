#include <chrono>
#include <iostream>
#include <stdexcept>

#include "station/commands/commands.h"
#include "station/commands/output_options.h"
#include "station/output/progress.h"
#include "station/session/replay_session.h"

namespace station {
namespace {

struct ReplayArguments {
  std::string recorded;
  CaptureRequest request;
  bool resume = false;
  OutputOptions output;
};

void run(ReplayArguments& arguments) {
  CaptureRequest& request = arguments.request;
  request.progress_style = arguments.output.progress_style();
  const auto began = std::chrono::steady_clock::now();
  const ReplayReport report = replay_session(arguments.recorded, request, arguments.resume);
  const double took_s = seconds_since(began);
  if (arguments.output.json)
    std::cout << nlohmann::json{{"state", state_name(report.state)},
                                {"runs", report.runs},
                                {"files", report.files},
                                {"differences", report.differences},
                                {"recorded_s", report.recorded_s},
                                {"took_s", took_s}}
                     .dump()
              << "\n";
  else if (!arguments.output.quiet)
    std::cout << report.runs << " run(s), " << state_name(report.state) << "; " << report.files << " files, "
              << report.differences.size() << " differ; " << took_s << " s for a session of " << report.recorded_s
              << " s\n";
  if (!report.differences.empty())
    throw std::runtime_error(
        "the replay is not the recorded session: " + report.differences.front() +
        (report.differences.size() > 1 ? " (and " + std::to_string(report.differences.size() - 1) + " more)" : "") +
        "; compare " + request.session.string() + " with " + arguments.recorded);
}

}  // namespace

void add_replay_command(CLI::App& app) {
  auto arguments = std::make_shared<ReplayArguments>();
  CLI::App* command =
      app.add_subcommand("replay", "play a session that was captured with --record again, without hardware");
  command->add_option("session", arguments->recorded, "recorded session")->required();
  command->add_option("--out", arguments->request.session, "session folder to make")->required();
  command->add_flag("--resume", arguments->resume, "go on with a replay that was ended");
  arguments->output.add_to(*command);
  command->callback([arguments] { run(*arguments); });
}

}  // namespace station

#include <iostream>
#include <stdexcept>

#include "station/batch/batch_report.h"
#include "station/batch/do_batch.h"
#include "station/batch/run_task.h"
#include "station/commands/commands.h"
#include "station/commands/output_options.h"
#include "station/documents/reader.h"

namespace station {
namespace {

struct BatchArguments {
  DoBatchRequest request;
  std::filesystem::path folder;
  TaskRequest task;
  OutputOptions output;
};

void print(const nlohmann::json& description, const OutputOptions& output) {
  if (output.json)
    std::cout << description.dump() << "\n";
  else if (!output.quiet)
    std::cout << batch_text(description);
}

void run(BatchArguments& arguments) {
  if (arguments.request.plan.empty() || arguments.request.folder.empty())
    throw std::runtime_error("batch needs a plan and --out, a folder; see threadstation batch --help");
  arguments.request.progress_style = arguments.output.progress_style();
  const BatchOutcome outcome = do_batch(arguments.request);
  print(outcome.description, arguments.output);
  if (!outcome.submitted.empty() && !arguments.output.quiet && !arguments.output.json)
    std::cout << outcome.submitted << "\n";
  if (outcome.bad > 0)
    throw std::runtime_error(std::to_string(outcome.bad) + " of " + std::to_string(outcome.tasks) +
                             " tasks are not done; put right what failed, and the same command does the rest");
}

}  // namespace

void add_batch_command(CLI::App& app) {
  auto arguments = std::make_shared<BatchArguments>();
  DoBatchRequest& request = arguments->request;
  CLI::App* command = app.add_subcommand(
      "batch", "many sessions, threads, scenes or figures: develop, fit, weave, report, here or by Slurm");
  command->add_option("plan", request.plan, "file of the steps and what they are done with");
  command->add_option("--out", request.folder, "folder of the batch; the same again goes on with it");
  command->add_option("--on", request.on, "where the tasks run: this computer, or a cluster's Slurm")
      ->check(CLI::IsMember({"local", "slurm"}))
      ->capture_default_str();
  command->add_option("--cores", request.local.cores, "local: the most cores, 0 for all")->check(CLI::Range(0, 4096));
  command
      ->add_option("--memory-gib", request.local.memory_gib,
                   "local: the most memory that tasks are expected to take together; four fifths of what is free "
                   "without it")
      ->check(CLI::Range(0.1, 1e5));
  command->add_flag("--wait", request.wait, "Slurm: ask it once a minute until it has no more of them");
  arguments->output.add_to(*command);
  command->require_subcommand(0, 1);
  const auto add = [&](const char* name, const char* description) {
    CLI::App* sub = command->add_subcommand(name, description);
    sub->add_option("folder", arguments->folder, "folder of the batch")->required();
    return sub;
  };
  CLI::App* status = add("status", "how far it is, and what failed and why");
  arguments->output.add_to(*status);
  status->callback([arguments] { print(batch_status(arguments->folder), arguments->output); });
  CLI::App* cancel = add("cancel", "stop it, here or in Slurm; what is done stays");
  cancel->callback([arguments] { std::cout << cancel_batch(arguments->folder) << "\n"; });
  CLI::App* report = add("report", "time, memory and failures of each step, also as report.html in its folder");
  arguments->output.add_to(*report);
  report->callback([arguments] {
    const nlohmann::json description = batch_status(arguments->folder);
    write_text_file(arguments->folder / "report.html", batch_page(description));
    print(description, arguments->output);
  });
  CLI::App* task = add("task", "one task of it, as the batch itself starts them");
  task->add_option("--step", arguments->task.step, "the step's name")->required();
  task->add_option("--item", arguments->task.item, "the item's number")->required();
  task->add_option("--cores", arguments->task.cores, "cores that it may use")->delimiter(',');
  task->callback([arguments] {
    arguments->task.folder = arguments->folder;
    if (run_task(arguments->task) == TaskOutcome::kept) std::cout << "it is done already\n";
  });
  command->callback([arguments, command] {
    if (command->get_subcommands().empty()) run(*arguments);
  });
}

}  // namespace station

#include <iostream>
#include <map>
#include <stdexcept>

#include "station/commands/commands.h"
#include "station/commands/output_options.h"
#include "station/documents/thread_file.h"
#include "station/thread/invert/fit_document.h"
#include "station/thread/invert/invert_session.h"

namespace station {
namespace {

struct InvertArguments {
  InvertRequest request;
  std::string solver = "lm", out;
  std::vector<std::string> held;
  OutputOptions output;
};

void run(InvertArguments& arguments) {
  InvertRequest& request = arguments.request;
  if (!arguments.out.empty()) request.out = arguments.out;
  for (inversion::ParameterGroup group : inversion::kParameterGroups)
    for (const std::string& name : arguments.held)
      if (name == inversion::name_of(group)) request.fit.held.push_back(group);
  request.fit.solver = arguments.solver == "adam" ? inversion::Solver::adam : inversion::Solver::levenberg_marquardt;
  if (request.fit.tinted && request.fit.model != inversion::ModelKind::thread)
    throw std::runtime_error("--tint was given with --model " + name_of(request.fit.model) +
                             ", and only a thread's highlight has a tint; leave out one of them");
  request.progress_style = arguments.output.progress_style();
  const InvertResult result = invert_session(request);
  if (arguments.output.json)
    std::cout << to_json(result).dump() << "\n";
  else if (!arguments.output.quiet)
    std::cout << describe(result);
}

}  // namespace

void add_invert_command(CLI::App& app) {
  auto arguments = std::make_shared<InvertArguments>();
  CLI::App* command = app.add_subcommand("invert", "fit a thread to a session's developed views");
  command->add_option("session", arguments->request.session, "session folder")->required();
  command->add_option("--out", arguments->out, "write the model's file here as well");
  std::map<std::string, inversion::ModelKind> models = names_of_models();
  models.erase(name_of(inversion::ModelKind::paper));
  command
      ->add_option("--model", arguments->request.fit.model,
                   "scattering model: the thread's, or a baseline (the yarn is a reconstruction)")
      ->transform(CLI::CheckedTransformer(models));
  command->add_option("--solver", arguments->solver, "lm: Levenberg-Marquardt on recorded paths; adam: the paper's")
      ->check(CLI::IsMember({"lm", "adam"}));
  command->add_option("--exit", arguments->request.fit.start.exit, "where light leaves the thread")
      ->transform(CLI::CheckedTransformer(thread_exits()));
  command->add_flag("--tint", arguments->request.fit.tinted,
                    "find the tint of the thread's highlight too: metallic threads (without the prior)");
  std::vector<std::string> groups;
  for (inversion::ParameterGroup group : inversion::kParameterGroups) groups.push_back(inversion::name_of(group));
  command->add_option("--hold", arguments->held, "leave this group of parameters at its start")
      ->check(CLI::IsMember(groups));
  command
      ->add_option("--hold-out", arguments->request.held_out,
                   "leave out so many views, and tell how they are predicted")
      ->check(CLI::Range(0, 1000));
  command->add_option("--paths", arguments->request.fit.paths_per_block, "light paths per block, one number a round")
      ->check(CLI::Range(1, 100000));
  command->add_option("--adam-steps", arguments->request.fit.adam_steps, "steps of --solver adam")
      ->check(CLI::Range(1, 100000));
  command->add_option("--adam-paths", arguments->request.fit.adam_paths, "light paths per block for each of them")
      ->check(CLI::Range(1, 100000));
  command->add_flag("!--eq6", arguments->request.fit.robust, "all views and blocks count as in eq. 6, none less");
  command->add_option("--prior", arguments->request.fit.prior_weight, "weight of the simulated threads' prior; 0: none")
      ->check(CLI::Range(0.0, 1000.0));
  CLI::Option* paper = command->add_flag_callback(
      "--paper", [arguments] { arguments->request.fit.model = inversion::ModelKind::paper; },
      "the paper's own recipe: single pixels, eq. 6 as printed, light leaves where it came in, Adam");
  for (const char* other : {"--model", "--solver", "--exit", "--hold", "--paths", "--eq6", "--prior", "--tint"})
    paper->excludes(command->get_option(other));
  command
      ->add_option("--pixel-paths", arguments->request.fit.paths_per_pixel,
                   "light paths per pixel in each of its steps")
      ->check(CLI::Range(inversion::kPathBatches, 100000))
      ->needs(paper);
  command->add_option("--spp", arguments->request.samples_per_pixel, "samples per pixel of the fitted views")
      ->check(CLI::Range(1, 65536));
  command->add_option("--seed", arguments->request.fit.seed, "of the light paths");
  arguments->output.add_to(*command);
  command->callback([arguments] { run(*arguments); });
}

}  // namespace station

#include <algorithm>
#include <iostream>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "station/commands/commands.h"
#include "station/commands/output_options.h"
#include "station/reproduce/reproduce.h"

namespace station {
namespace {

struct ReproduceArguments {
  ReproduceRequest request;
  OutputOptions output;
};

void run(ReproduceArguments& arguments) {
  arguments.request.progress_style = arguments.output.progress_style();
  const FiguresPage page = reproduce(arguments.request);
  if (arguments.output.json)
    std::cout << to_json(page).dump() << "\n";
  else if (!arguments.output.quiet)
    std::cout << describe(page) << (arguments.request.out / "index.html").string() << "\n";
  const auto failed = std::ranges::count_if(page.figures, [](const MadeFigure& made) { return !made.problem.empty(); });
  if (failed > 0)
    throw std::runtime_error(std::to_string(failed) +
                             " figure(s) could not be made, for the reasons above; the same command tries them again");
}

}  // namespace

void add_reproduce_command(CLI::App& app) {
  auto arguments = std::make_shared<ReproduceArguments>();
  ReproduceRequest& request = arguments->request;
  CLI::App* command = app.add_subcommand("reproduce", "figures and numbers of the paper, made anew, on one page");
  command->add_option("figures", request.figures, "their numbers as in the paper; all without them");
  command->add_option("--out", request.out, "folder; the same again goes on with it")->required();
  command->add_flag("--quick", request.quick, "smaller, noisier and fewer of each");
  arguments->output.add_to(*command);
  command->callback([arguments] { run(*arguments); });
}

}  // namespace station

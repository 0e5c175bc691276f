#include <iostream>

#include "station/commands/commands.h"
#include "station/commands/demo.h"
#include "station/commands/output_options.h"
#include "station/documents/number_text.h"

namespace station {
namespace {

struct DemoArguments {
  DemoRequest request;
  OutputOptions output;
};

std::string clothes(const DemoResult& result) {
  std::string names;
  for (const std::filesystem::path& picture : result.cloth) names += (names.empty() ? "" : ", ") + picture.string();
  return names;
}

void run(DemoArguments& arguments) {
  arguments.request.progress_style = arguments.output.progress_style();
  const DemoResult result = run_demo(arguments.request);
  if (arguments.output.json)
    std::cout << nlohmann::json{{"session", result.session},
                                {"thread", result.thread},
                                {"relative_rmse", result.relative_rmse},
                                {"cloth", result.cloth},
                                {"report", result.report}}
                     .dump()
              << "\n";
  else
    std::cout << (result.kept ? "kept the pictures of an earlier demo in this folder; --fresh takes them again\n" : "")
              << "session  " << result.session.string() << "\nthread   " << result.thread.string()
              << "  (relative RMSE " << number_text(100 * result.relative_rmse, 1) << " %)\n"
              << "cloth    " << clothes(result) << "\nreport   " << result.report.string() << "\n";
}

}  // namespace

void add_demo_command(CLI::App& app) {
  auto arguments = std::make_shared<DemoArguments>();
  CLI::App* command = app.add_subcommand("demo", "the whole job on the simulated bench");
  command->add_option("--out", arguments->request.out, "folder for the results")->capture_default_str();
  command->add_flag("--quick", arguments->request.quick, "fewer samples per pixel: noisier, within a minute");
  command->add_flag("--fresh", arguments->request.fresh, "take every picture again");
  arguments->output.add_to(*command);
  command->callback([arguments] { run(*arguments); });
}

}  // namespace station

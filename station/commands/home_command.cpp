#include <iostream>

#include "station/bench/home_platform.h"
#include "station/commands/commands.h"
#include "station/commands/output_options.h"
#include "station/documents/degree.h"
#include "station/documents/number_text.h"

namespace station {

void add_home_command(CLI::App& app) {
  struct HomeArguments {
    HomeRequest request;
    OutputOptions output;
  };
  auto arguments = std::make_shared<HomeArguments>();
  CLI::App* command = turns_platform(app.add_subcommand("home", "turn the platform to its angle 0"));
  command->add_option("--rig", arguments->request.rig, "rig file")->required();
  command->add_flag(
      "--mark", arguments->request.stands_at_mark,
      "the platform was turned to its mark by hand: forget where it was left (rigs without a home switch)");
  arguments->output.add_to(*command);
  command->callback([arguments] {
    const auto person = asked_person(arguments->output.json);
    arguments->request.asked = person.get();
    const double angle_deg = home_platform(arguments->request) / kDegree;
    if (arguments->output.json)
      std::cout << nlohmann::json{{"angle_deg", angle_deg}}.dump() << "\n";
    else if (!arguments->output.quiet)
      std::cout << "the platform stands at " << number_text(angle_deg, 3) << " deg\n";
  });
}

}  // namespace station

#include <cmath>
#include <cstdio>
#include <iostream>

#include "station/commands/commands.h"
#include "station/documents/plan_file.h"
#include "station/documents/reader.h"
#include "station/session/capture_session.h"

namespace station {
namespace {

struct PlanArguments {
  std::string rig, spool, plan, out;
  bool json = false;
};

void print(const Plan& plan) {
  for (const PlanStep& step : plan.steps)
    std::printf("%-36s %-8s %-10s lamp %-5s %s %7.1f deg%s\n", step.id.c_str(), kind_name(step.kind).c_str(),
                mounting_name(step.mounting).c_str(), lamp_name(step.lamp).c_str(),
                step.room_light ? "room light" : "dark room ", file_degrees(step.platform_angle_rad),
                step.exposure_of.empty() ? "" : (", exposed as " + step.exposure_of).c_str());
  const double seconds = estimated_duration_s(plan);
  std::printf("%zu view(s), %zu steps, about %.0f min\n", view_count(plan), plan.steps.size(), std::ceil(seconds / 60));
}

void run(const PlanArguments& arguments) {
  const Plan plan = arguments.plan.empty() ? plan_of(read_rig(arguments.rig),
                                                     arguments.spool.empty() ? Spool{} : read_spool(arguments.spool))
                                           : plan_from_json(read_json_file(arguments.plan), arguments.plan);
  if (!arguments.out.empty()) write_json_file(arguments.out, plan_to_json(plan));
  if (arguments.json)
    std::cout << nlohmann::json{{"plan", plan_to_json(plan)}, {"estimated_s", estimated_duration_s(plan)}}.dump()
              << "\n";
  else
    print(plan);
}

}  // namespace

void add_plan_command(CLI::App& app) {
  auto arguments = std::make_shared<PlanArguments>();
  CLI::App* command = app.add_subcommand("plan", "the steps of a capture and how long it takes, without hardware");
  CLI::Option* rig = command->add_option("--rig", arguments->rig, "the plan that this rig file asks for");
  CLI::Option* plan = command->add_option("--plan", arguments->plan, "an edited plan to check");
  rig->excludes(plan);
  command
      ->add_option("--spool", arguments->spool,
                   "of what is photographed; a cloth on the cylinder has a plan of its own")
      ->needs(rig);
  command->add_option("--out", arguments->out, "write it as JSON, to be edited and given to capture --plan");
  command->add_flag("--json", arguments->json, "as JSON, for machines");
  command->callback([=] {
    if (!rig->count() && !plan->count()) throw CLI::RequiredError("--rig or --plan");
    run(*arguments);
  });
}

}  // namespace station

#include "station/documents/plan_file.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "station/documents/degree.h"
#include "station/documents/reader.h"

namespace station {
namespace {

using nlohmann::json;
constexpr double kWidestAngleDeg = 1e6;  // check_plan knows the limits of a platform

StepKind kind_from_name(const std::string& name) {
  for (const StepKind kind : {StepKind::pose, StepKind::bracket, StepKind::dark})
    if (name == kind_name(kind)) return kind;
  return StepKind::view;
}

json step_to_json(const PlanStep& step) {
  json document = {{"id", step.id},
                   {"kind", kind_name(step.kind)},
                   {"mounting", mounting_name(step.mounting)},
                   {"lamp", lamp_name(step.lamp)},
                   {"room_light", step.room_light},
                   {"platform_angle_deg", file_degrees(step.platform_angle_rad)}};
  if (step.kind == StepKind::dark || step.kind == StepKind::bracket) document["exposure_of"] = step.exposure_of;
  if (step.kind == StepKind::bracket) {
    document["stops"] = step.stops;
    if (step.if_needed) document["if_needed"] = true;
  }
  if (step.exposure_s) document["exposure_s"] = *step.exposure_s;
  if (!step.verify.empty()) document["verify"] = step.verify;
  return document;
}

PlanStep read_step(ObjectReader& reader) {
  PlanStep step;
  step.id = reader.text("id");
  step.kind = kind_from_name(reader.choice("kind", {"pose", "view", "exposure", "dark"}));
  step.mounting = mounting_from_name(reader.choice("mounting", {"horizontal", "vertical"}));
  step.lamp = lamp_from_name(reader.choice("lamp", {"off", "front", "back", "front_left"}));
  step.room_light = reader.flag("room_light");
  step.platform_angle_rad = reader.number("platform_angle_deg", -kWidestAngleDeg, kWidestAngleDeg) * kDegree;
  if (step.kind == StepKind::dark || step.kind == StepKind::bracket) step.exposure_of = reader.text("exposure_of");
  if (step.kind == StepKind::bracket) {
    step.stops = reader.number("stops", -10, 10);
    if (reader.has("if_needed")) step.if_needed = reader.flag("if_needed");
  }
  if (reader.has("exposure_s")) step.exposure_s = reader.number("exposure_s", 1e-6, 3600);
  if (reader.has("verify")) {
    const json& checks = reader.raw("verify");
    const bool texts =
        checks.is_array() && std::ranges::all_of(checks, [](const json& check) { return check.is_string(); });
    if (!texts) reader.refuse("verify", "expected a list of the checks that a picture must pass, such as [\"focus\"]");
    step.verify = checks.get<std::vector<std::string>>();
  }
  reader.finish();
  return step;
}

}  // namespace

json plan_to_json(const Plan& plan) {
  json steps = json::array();
  for (const PlanStep& step : plan.steps) steps.push_back(step_to_json(step));
  return {{"format", "threadstation/plan"}, {"version", 1}, {"steps", steps}};
}

Plan plan_from_json(const json& document, const std::string& source) {
  ObjectReader reader(document, source, "plan");
  Plan plan;
  for (ObjectReader& step : reader.objects("steps")) plan.steps.push_back(read_step(step));
  reader.finish();
  if (const std::optional<std::string> problem = check_plan(plan)) throw std::runtime_error(source + ": " + *problem);
  return plan;
}

std::string lamp_name(rig::Lamp lamp) {
  switch (lamp) {
    case rig::Lamp::front:
      return "front";
    case rig::Lamp::back:
      return "back";
    case rig::Lamp::front_left:
      return "front_left";
    case rig::Lamp::off:
      break;
  }
  return "off";
}

std::string mounting_name(rig::Mounting mounting) {
  return mounting == rig::Mounting::horizontal ? "horizontal" : "vertical";
}

std::string kind_name(StepKind kind) {
  switch (kind) {
    case StepKind::pose:
      return "pose";
    case StepKind::view:
      return "view";
    case StepKind::bracket:
      return "exposure";
    case StepKind::dark:
      break;
  }
  return "dark";
}

rig::Lamp lamp_from_name(const std::string& name) {
  for (const rig::Lamp lamp : {rig::Lamp::off, rig::Lamp::front, rig::Lamp::back, rig::Lamp::front_left})
    if (name == lamp_name(lamp)) return lamp;
  throw std::runtime_error("the lamp is said to be '" + name + "'; it is off, front, back or front_left");
}

rig::Mounting mounting_from_name(const std::string& name) {
  for (const rig::Mounting mounting : {rig::Mounting::horizontal, rig::Mounting::vertical})
    if (name == mounting_name(mounting)) return mounting;
  throw std::runtime_error("the mounting is said to be '" + name + "'; it is horizontal or vertical");
}

double file_degrees(double angle_rad) {
  return std::round(angle_rad / kDegree * 1e9) / 1e9;
}

}  // namespace station

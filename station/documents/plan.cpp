#include "station/documents/plan.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>
#include <sstream>
#include <stdexcept>

#include "station/documents/degree.h"
#include "station/documents/disk/file_name.h"

namespace station {
namespace {
constexpr std::size_t kReflections = 6, kTransmissions = 5;

// From two oblique angles the tags give the holder's place ten times better than from the front.
constexpr std::array kPoseAngles_deg{-35.0, 35.0};

// A picture without these findings is of no use; other checks are made wherever the picture allows them.
const std::vector<std::string> kPoseMustShow{"settings", "tags"};
const std::vector<std::string> kViewMustShow{"settings", "saturation", "exposure", "focus"};

void add_poses(Plan& plan, const std::string& name, rig::Mounting mounting) {
  for (const double angle_deg : kPoseAngles_deg)
    plan.steps.push_back({.id = name + (angle_deg < 0 ? "-1" : "-2"),
                          .kind = StepKind::pose,
                          .mounting = mounting,
                          .lamp = rig::Lamp::off,
                          .room_light = true,
                          .platform_angle_rad = angle_deg * kDegree,
                          .exposure_of = {},
                          .verify = kPoseMustShow});
}

std::string short_number(double value) {
  std::ostringstream text;
  text << value;
  return text.str();
}

// The id of a bracket step: "bracket-reflection-horizontal-1-minus-2".
std::string bracket_id(const std::string& view, double stops) {
  std::string number = short_number(std::abs(stops));
  std::replace(number.begin(), number.end(), '.', '_');
  return "bracket-" + view + (stops < 0 ? "-minus-" : "-plus-") + number;
}

void add_views(Plan& plan, const std::string& name, rig::Mounting mounting, rig::Lamp lamp,
               const std::vector<double>& angles_deg, const PlanRequest& request) {
  for (std::size_t i = 0; i < angles_deg.size(); ++i) {
    plan.steps.push_back({.id = name + "-" + std::to_string(i + 1),
                          .kind = StepKind::view,
                          .mounting = mounting,
                          .lamp = lamp,
                          .room_light = false,
                          .platform_angle_rad = angles_deg[i] * kDegree,
                          .exposure_of = {},
                          .verify = kViewMustShow});
    const PlanStep view = plan.steps.back();
    for (const double stops : request.bracket_stops) {
      PlanStep bracket = view;
      bracket.id = bracket_id(view.id, stops);
      bracket.kind = StepKind::bracket;
      bracket.exposure_of = view.id;
      bracket.stops = stops;
      bracket.if_needed = request.brackets_if_needed;
      bracket.verify = {"settings"};
      plan.steps.push_back(bracket);
    }
  }
}

// The holder stays as the last view left it, because a dark does not show it.
void add_darks(Plan& plan) {
  const PlanStep last = plan.steps.back();
  for (std::size_t i = 0, count = plan.steps.size(); i < count; ++i) {
    if (plan.steps[i].kind == StepKind::view) {
      const std::string view = plan.steps[i].id;
      plan.steps.push_back({.id = "dark-" + view,
                            .kind = StepKind::dark,
                            .mounting = last.mounting,
                            .lamp = rig::Lamp::off,
                            .room_light = false,
                            .platform_angle_rad = last.platform_angle_rad,
                            .exposure_of = view,
                            .verify = {"settings"}});
    }
  }
}

void require_count(const char* what, std::size_t found, std::size_t wanted) {
  if (found != wanted) {
    throw std::runtime_error("a capture plan has " + std::to_string(wanted) + " " + what + " angles, " +
                             std::to_string(found) + " were given; correct the list");
  }
}

std::optional<std::string> angle_problem(const PlanStep& step, double largest_angle_rad) {
  if (!std::isfinite(step.platform_angle_rad)) return "the platform angle is not a finite number";
  if (std::abs(step.platform_angle_rad) > largest_angle_rad * (1 + 1e-9)) {
    return "the platform angle " + std::to_string(step.platform_angle_rad / kDegree) + " deg is beyond +-" +
           std::to_string(largest_angle_rad / kDegree) + " deg";
  }
  return std::nullopt;
}

std::optional<std::string> light_problem(const PlanStep& step) {
  const bool lit = step.kind == StepKind::view || step.kind == StepKind::bracket;
  if (lit && (step.lamp == rig::Lamp::off || step.room_light)) return "a view needs the lamp on and the room light off";
  if (step.kind == StepKind::dark && (step.lamp != rig::Lamp::off || step.room_light))
    return "a dark needs the lamp and the room light off";
  if (step.kind == StepKind::pose && !step.room_light) return "a pose picture needs the room light on";
  return std::nullopt;
}

// `earlier`: the steps before this one.
std::optional<std::string> order_problem(const PlanStep& step, const std::map<std::string, StepKind>& earlier,
                                         const std::set<rig::Mounting>& posed, bool any_pose) {
  if (earlier.contains(step.id)) return "the id stands twice in the plan";
  if (any_pose && step.kind == StepKind::view && !posed.contains(step.mounting))
    return "a pose picture with its mounting has to come before it";
  const bool repeats = step.kind == StepKind::dark || step.kind == StepKind::bracket;
  if (!repeats && !step.exposure_of.empty())
    return "only a dark and a bracket's exposure repeat the exposure of another step";
  if (step.kind == StepKind::bracket ? !(std::abs(step.stops) >= 0.3 && std::abs(step.stops) <= 10) : step.stops != 0)
    return "a bracket's exposure, and nothing else, is 0.3 to 10 stops from its view's";
  if (step.if_needed && step.kind != StepKind::bracket) return "if_needed is for a bracket's exposure";
  if (step.exposure_s && (repeats || !(*step.exposure_s > 0 && *step.exposure_s <= 3600)))
    return "exposure_s is for a pose or a view, above 0 and up to 3600 s";
  const auto view = earlier.find(step.exposure_of);
  if (repeats && (view == earlier.end() || view->second != StepKind::view))
    return "exposure_of '" + step.exposure_of + "' names no view before it";
  return std::nullopt;
}

std::optional<std::string> verify_problem(const PlanStep& step) {
  const std::vector<std::string>& known = verifiable(step.kind);
  for (const std::string& check : step.verify) {
    if (std::ranges::find(known, check) != known.end()) continue;
    std::string names;
    for (const std::string& name : known) names += (names.empty() ? "" : ", ") + name;
    return "verify names '" + check + "'; pictures of this kind can be verified for " + names;
  }
  return std::nullopt;
}

bool needs_a_hand(const PlanStep& before, const PlanStep& step) {
  return before.mounting != step.mounting || before.lamp != step.lamp || before.room_light != step.room_light;
}

}  // namespace

const std::vector<std::string>& verifiable(StepKind kind) {
  static const std::vector<std::string> pose{"settings", "focus", "tags", "orientation", "angle", "bench", "motion"},
      view{"settings", "focus", "saturation", "exposure", "lamp", "lamp_side", "tags", "angle", "bench", "motion"},
      bracket{"settings"}, dark{"settings", "dark"};
  switch (kind) {
    case StepKind::pose:
      return pose;
    case StepKind::view:
      return view;
    case StepKind::bracket:
      return bracket;
    case StepKind::dark:
      break;
  }
  return dark;
}

bool is_reflection(const PlanStep& step) {
  return step.kind == StepKind::view && (step.lamp == rig::Lamp::front || step.lamp == rig::Lamp::front_left);
}

bool is_transmission(const PlanStep& step) {
  return step.kind == StepKind::view && step.lamp == rig::Lamp::back;
}

std::size_t view_count(const Plan& plan) {
  return static_cast<std::size_t>(std::count_if(plan.steps.begin(), plan.steps.end(),
                                                [](const PlanStep& step) { return step.kind == StepKind::view; }));
}

const PlanStep* find_view(const Plan& plan, std::size_t number) {
  for (const PlanStep& step : plan.steps)
    if (step.kind == StepKind::view && number-- == 1) return &step;
  return nullptr;
}

const PlanStep* find_step(const Plan& plan, const std::string& id) {
  const auto found =
      std::find_if(plan.steps.begin(), plan.steps.end(), [&](const PlanStep& step) { return step.id == id; });
  return found == plan.steps.end() ? nullptr : &*found;
}

Plan make_capture_plan(const PlanRequest& request) {
  using rig::Lamp, rig::Mounting;
  require_count("reflection", request.reflection_angles_deg.size(), kReflections);
  require_count("transmission", request.transmission_angles_deg.size(), kTransmissions);
  Plan plan;
  add_poses(plan, "pose-horizontal", Mounting::horizontal);
  add_views(plan, "reflection-horizontal", Mounting::horizontal, Lamp::front, request.reflection_angles_deg, request);
  add_views(plan, "transmission", Mounting::horizontal, Lamp::back, request.transmission_angles_deg, request);
  add_poses(plan, "pose-vertical", Mounting::vertical);
  add_views(plan, "reflection-vertical", Mounting::vertical, Lamp::front, request.reflection_angles_deg, request);
  add_darks(plan);
  if (request.reference_chip)
    for (PlanStep& step : plan.steps)
      if (step.kind == StepKind::view) step.verify.push_back("lamp");
  if (const std::optional<std::string> problem = check_plan(plan)) throw std::runtime_error(*problem);
  return plan;
}

Plan make_fabric_plan(const PlanRequest& request) {
  Plan plan;
  add_views(plan, "fabric-right", rig::Mounting::horizontal, rig::Lamp::front, {0}, request);
  add_views(plan, "fabric-left", rig::Mounting::horizontal, rig::Lamp::front_left, {0}, request);
  add_darks(plan);
  if (const std::optional<std::string> problem = check_plan(plan)) throw std::runtime_error(*problem);
  return plan;
}

std::optional<std::string> check_plan(const Plan& plan, double largest_angle_rad) {
  std::map<std::string, StepKind> earlier;
  std::set<rig::Mounting> posed;
  const bool any_pose = std::any_of(plan.steps.begin(), plan.steps.end(),
                                    [](const PlanStep& step) { return step.kind == StepKind::pose; });
  for (const PlanStep& step : plan.steps) {
    std::optional<std::string> problem = problem_with_name(step.id);
    if (!problem) problem = order_problem(step, earlier, posed, any_pose);
    if (!problem) problem = angle_problem(step, largest_angle_rad);
    if (!problem) problem = light_problem(step);
    if (!problem) problem = verify_problem(step);
    if (problem) {
      return "plan step " + std::to_string(earlier.size() + 1) +
             (problem_with_name(step.id) ? "" : " '" + step.id + "'") + ": " + *problem + "; correct the plan";
    }
    earlier.emplace(step.id, step.kind);
    if (step.kind == StepKind::pose) posed.insert(step.mounting);
  }
  if (view_count(plan) == 0) return "the plan has no view; add one";
  return std::nullopt;
}

double estimated_duration_s(const Plan& plan, const StepDurations& durations) {
  double total_s = 0;
  for (std::size_t i = 0; i < plan.steps.size(); ++i) {
    const bool metered = plan.steps[i].kind == StepKind::pose || plan.steps[i].kind == StepKind::view;
    total_s += metered ? durations.picture_s : durations.dark_s;
    if (i == 0 || needs_a_hand(plan.steps[i - 1], plan.steps[i])) total_s += durations.arrange_s;
  }
  return total_s;
}

}  // namespace station

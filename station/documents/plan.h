// A capture plan: the list of a session's pictures, as data. Each step states the whole arrangement that it needs (the
// holder on the platform at its nominal pose, lamp, room light, platform angle), so that any step may come first after
// an interruption. Angles are in radians, 0 where the front of the holder faces the camera.
#pragma once

#include <cstddef>
#include <numbers>
#include <optional>
#include <string>
#include <vector>

#include "rig/people/operator.h"

namespace station {

// The kinds of step. A pose picture is taken under the room light and shows the holder's tags. A view is one of the 17
// pictures that are fitted. A bracket step takes the picture of a view once more, `stops` longer. A dark is taken
// without any light, with the exposure of the view that it belongs to.
enum class StepKind { pose, view, bracket, dark };

struct PlanStep {
  std::string id;  // also the name of the picture's file
  StepKind kind = StepKind::view;
  rig::Mounting mounting = rig::Mounting::horizontal;
  rig::Lamp lamp = rig::Lamp::off;
  bool room_light = false;
  double platform_angle_rad = 0.0;
  std::string exposure_of;             // dark and bracket only: the view whose camera settings it repeats
  double stops = 0.0;                  // bracket only: how much longer than the view's; negative: shorter
  bool if_needed = false;              // bracket only: left out where the view's range does not need it (bracket.h)
  std::optional<double> exposure_s{};  // pose and view only: fixed exposure time, instead of metering
  // Checks (verdict.h) that must give a finding: without one the picture is refused. Checks that are not listed are
  // made wherever the picture shows what they need.
  std::vector<std::string> verify{};

  bool operator==(const PlanStep&) const = default;
};

struct Plan {
  std::vector<PlanStep> steps;

  bool operator==(const Plan&) const = default;
};

bool is_reflection(const PlanStep& step);    // a view with a lamp in front
bool is_transmission(const PlanStep& step);  // a view with the lamp behind
std::size_t view_count(const Plan& plan);
const PlanStep* find_view(const Plan& plan, std::size_t number);     // counted from 1; nullptr: none
const PlanStep* find_step(const Plan& plan, const std::string& id);  // nullptr: no such step

struct PlanRequest {
  std::vector<double> reflection_angles_deg = {-50, -30, -10, 10, 30, 50};  // 6, for each mounting
  std::vector<double> transmission_angles_deg = {-40, -20, 0, 20, 40};      // 5, threads horizontal
  std::vector<double> bracket_stops{};  // further exposures of each view; empty: one exposure only
  bool brackets_if_needed = false;      // false: they are always taken
  bool reference_chip = false;          // the rig has one: each view must then be verified for "lamp"
};

// The plan of a spool. With horizontal threads: 2 poses, 6 reflections, 5 transmissions; with vertical ones: 2 poses, 6
// reflections; after each view its further exposures; at the end a dark for each view. Errors: std::runtime_error when
// the angles are not 6 and 5, or check_plan finds something.
Plan make_capture_plan(const PlanRequest& request);

// The plan of a cloth on the black cylinder: the camera stands as for threads; the cloth is lit from the right (the
// lamp in front) and from the left; each view has a dark. Nothing on the cylinder shows its pose, so it is taken to
// stand in the middle of the platform.
Plan make_fabric_plan(const PlanRequest& request = {});

// The names of the checks that `verify` of a step of this kind may list.
const std::vector<std::string>& verifiable(StepKind kind);

// Returns one line about the first thing that makes the plan impossible, or nothing. A plan has a pose picture before
// the first view of each mounting, or none at all (pictures taken by hand: the holder is taken to stand at its nominal
// pose).
std::optional<std::string> check_plan(const Plan& plan, double largest_angle_rad = std::numbers::pi);

// Rough durations of steps, for the time left before the session has measured its own.
struct StepDurations {
  double picture_s = 8.0;  // a step with its metering, from asking to stored
  double dark_s = 4.0;
  double arrange_s = 40.0;  // a hand changes lamp, room light or mounting
};

double estimated_duration_s(const Plan& plan, const StepDurations& durations = {});

}  // namespace station

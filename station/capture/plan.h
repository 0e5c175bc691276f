// A capture plan: the list of pictures of a session, as data. Each step says the whole arrangement that it needs (the
// holder on the platform at its nominal pose, lamp, room light, platform angle), so that any step may come first
// after an interruption. Angles in radians, 0 where the front of the holder faces the camera.
#pragma once

#include <cstddef>
#include <numbers>
#include <optional>
#include <string>
#include <vector>

#include "rig/operator.h"

namespace station {

// pose: under the room light, for the tags on the holder. view: one of the 17. dark: no light at all, with the
// exposure of the view that it belongs to. exposure: the picture of a view once more, so many stops longer, for its bracket.
enum class StepKind { pose, view, exposure, dark };

struct PlanStep {
  std::string id;  // also the name of the picture's file
  StepKind kind = StepKind::view;
  rig::Mounting mounting = rig::Mounting::horizontal;
  rig::Lamp lamp = rig::Lamp::off;
  bool room_light = false;
  double platform_angle_rad = 0.0;
  std::string exposure_of;             // dark and exposure only: the view whose camera settings it repeats
  double stops = 0.0;                  // exposure only: from the view's
  bool if_needed = false;              // exposure only: left out where the view's range does without (bracket.h)
  std::optional<double> exposure_s{};  // pose and view only: this one, without metering
  // Checks (verdict.h) without which the picture is refused: those that can look look anyway, these must be able to.
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
const PlanStep* find_view(const Plan& plan, std::size_t number);     // 1: the first view; nullptr: there are fewer
const PlanStep* find_step(const Plan& plan, const std::string& id);  // nullptr: no such step

struct PlanRequest {
  std::vector<double> reflection_angles_deg = {-50, -30, -10, 10, 30, 50};  // 6, for each mounting
  std::vector<double> transmission_angles_deg = {-40, -20, 0, 20, 40};      // 5, threads horizontal
  std::vector<double> bracket_stops{};  // of the further exposures of each view; empty: one exposure
  bool brackets_if_needed = false;      // else always
  bool reference_patch = false;         // there is one: the lamp must be verified in each view
};

// Horizontal: 2 poses, 6 reflections, 5 transmissions; vertical: 2 poses, 6 reflections; after each view its further
// exposures; then a dark for each view.
// Errors: std::runtime_error when the angles are not 6 and 5, or check_plan finds something.
Plan make_capture_plan(const PlanRequest& request);

// Cloth on the cylinder, seen from where threads are seen and lit from the right (the lamp in front) and from the left; a
// dark for each. Nothing on the cylinder shows its pose: it stands in the middle of the platform.
Plan make_fabric_plan(const PlanRequest& request = {});

// What a picture of this kind can be verified for.
const std::vector<std::string>& verifiable(StepKind kind);

// One clear line about the first thing that makes the plan impossible. A plan has a pose picture before the first view of
// each mounting, or none at all (pictures taken by hand: the holder is believed to stand where it should).
std::optional<std::string> check_plan(const Plan& plan, double largest_angle_rad = std::numbers::pi);

// Rough durations for the time left before the session has measured its own.
struct StepDurations {
  double picture_s = 8.0;  // a step with its metering, from asking to stored
  double dark_s = 4.0;
  double arrange_s = 40.0;  // a hand changes lamp, room light or mounting
};

double estimated_duration_s(const Plan& plan, const StepDurations& durations = {});

}  // namespace station

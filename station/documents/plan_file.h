// Capture plans as documents (kind "plan") and the words that files use for lamp and mounting.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "rig/people/operator.h"
#include "station/documents/plan.h"

namespace station {

// The document of a plan:
//   {"format": "threadstation/plan", "version": 1,
//    "steps": [{"id", "kind": "pose" | "view" | "exposure" | "dark", "mounting", "lamp", "room_light",
//               "platform_angle_deg", "exposure_of" (dark and exposure), "stops" and "if_needed" (exposure),
//               "exposure_s" (pose and view), "verify": [checks]}, ...]}
// Three keys may be left out: "if_needed" is then false, "exposure_s" metered, and "verify" empty.
nlohmann::json plan_to_json(const Plan& plan);

// Reads a plan; `source` is the file that error messages name. Errors: std::runtime_error for an unknown or missing
// key, a wrong value, and what check_plan finds.
Plan plan_from_json(const nlohmann::json& document, const std::string& source);

std::string lamp_name(rig::Lamp lamp);              // "off" "front" "back" "front_left"
std::string mounting_name(rig::Mounting mounting);  // "horizontal" "vertical"
std::string kind_name(StepKind kind);               // "pose" "view" "exposure" (of a bracket) "dark"
rig::Lamp lamp_from_name(const std::string& name);  // throws std::runtime_error for any other word
rig::Mounting mounting_from_name(const std::string& name);

// An angle in degrees as files carry it: rounded to a billionth, so that 50 deg reads as 50.
double file_degrees(double angle_rad);

}  // namespace station

// One picture of a rig calibration: what it is for, how the bench stands, and how it is exposed.
#pragma once

#include <string>

#include "rig/people/operator.h"

namespace station {

enum class CalibrationRole { lens, turning, front_light, back_light, response, rapid, dark, white_field, colour };

struct CalibrationStep {
  std::string id;  // file name without extension
  CalibrationRole role = CalibrationRole::lens;
  rig::Arrangement arrangement;
  double platform_angle_rad = 0.0;
  // The object stands on the platform as a hand put it: the angle is changed so that it is seen as planned
  // (standing_target.h).
  bool follows_target = false;
  // Taken only while the pictures before it leave the lens less than well known.
  bool if_needed = false;
  std::string exposure_of{};  // an earlier step whose exposure it repeats, `stops` longer; empty: metered
  int stops = 0;
};

std::string to_text(CalibrationRole role);
// What the picture is taken again with: "camera", "platform", "light" or "response".
std::string part_of(CalibrationRole role);
CalibrationRole calibration_role(const std::string& text);  // throws on an unknown word

}  // namespace station

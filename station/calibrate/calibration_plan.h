// Which pictures a rig calibration needs: the tag board in the hand (lens), standing on the turning platform and lying on
// it (axis, world frame), the sensor's pictures (response_plan.h), and the Spectralon panel under the lamp in front and
// behind (light, vignetting).
#pragma once

#include <string>
#include <vector>

#include "rig/operator.h"
#include "station/documents/rig_file.h"

namespace station {

enum class CalibrationRole { lens, turning, front_light, back_light, response, rapid, dark, white_field, colour };

struct CalibrationStep {
  std::string id;  // file name without extension
  CalibrationRole role = CalibrationRole::lens;
  rig::Arrangement arrangement;
  double platform_angle_rad = 0.0;
  std::string exposure_of{};  // an earlier step whose exposure it repeats, `stops` longer; empty: metered
  int stops = 0;
};

std::vector<CalibrationStep> make_calibration_plan(const RigFile& rig);

std::string to_text(CalibrationRole role);
CalibrationRole calibration_role(const std::string& text);  // throws on an unknown word

}  // namespace station

// The sensor's part of a rig calibration, from its pictures (response_plan.h).
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "station/bench/calibrate/calibration_pictures.h"
#include "station/documents/sensor_section.h"

namespace station {

bool is_sensor_role(CalibrationRole role);

// Others than the sensor's pictures are passed over. Pictures are read one after the other and not kept. Errors:
// std::runtime_error when pictures are missing, do not serve, or a gate is not passed.
SensorSection solve_response(const std::filesystem::path& folder, const std::vector<CalibrationPicture>& pictures,
                             const std::function<void(const std::string& label)>& progress);

// What was found, in two lines for people.
std::string describe(const SensorSection& sensor);

}  // namespace station

// The acceptance checks of calibrations (calibration/sensor/gate.h) in documents and in text.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "calibration/sensor/gate.h"
#include "station/documents/reader.h"

namespace station {

nlohmann::json to_json(const std::vector<calibration::Gate>& gates);
std::vector<calibration::Gate> parse_gates(ObjectReader& reader, const std::string& key);

// The failed checks in one line, empty when all have passed: "rms of the corners used, px: 0.7, limit 0.5 (corners are
// ...); ...".
std::string failed_gates(const std::vector<calibration::Gate>& gates);

}  // namespace station

// Acceptance checks in documents and in text.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "calibration/gate.h"
#include "station/documents/reader.h"

namespace station {

nlohmann::json to_json(const std::vector<calibration::Gate>& gates);
std::vector<calibration::Gate> parse_gates(ObjectReader& reader, const std::string& key);

// "rms of the corners used, px: 0.7, limit 0.5 (corners are ...); ..." for those that are not kept; empty when all are.
std::string failed_gates(const std::vector<calibration::Gate>& gates);

}  // namespace station

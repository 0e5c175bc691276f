// Gates of a calibration in a document: a list of {"name", "value", "limit", "passed", "reason"}.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "calibration/gate.h"
#include "station/documents/reader.h"

namespace station {

nlohmann::json gates_json(const std::vector<calibration::Gate>& gates);
std::vector<calibration::Gate> parse_gates(ObjectReader& reader);  // its key "gates"

// Those that failed, in one line with found value, limit and reason; empty when all passed.
std::string failed_gates(const std::vector<calibration::Gate>& gates);

}  // namespace station

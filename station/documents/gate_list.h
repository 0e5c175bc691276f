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

// Throws std::runtime_error with the reasons of those that did not pass: "<what> is not good enough: ...".
void refuse_failed_gates(const std::vector<calibration::Gate>& gates, const std::string& what);

}  // namespace station

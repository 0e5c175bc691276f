// The spool form of the technician's page: what a person (or a barcode scanner) fills in, as a spool file and a sample.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "station/documents/sample.h"
#include "station/serve/workspace.h"

namespace station {

// The sample that a form describes. Throws Refused (400) for one without any name, or with too long a text.
Sample sample_of_form(const nlohmann::json& form);

// {"barcode", "name" (one of the two filled in), "lot", "material", "colour", "note": texts; "turns", "diameter_mm":
// numbers; "sheets"; "simulated": on a simulated rig the ready spool whose fibers stand on the bench}. The holder is
// that of the rig file. Writes both files under one name, which it returns; a spool of the same barcode (or name) and
// lot is written anew. Throws Refused (400) when the rig file has no holder, and with the line of the code that reads
// spool files when they would be refused.
std::string write_spool(const nlohmann::json& form, const Workspace& workspace, const std::filesystem::path& rig);

// Ready spools that a simulated bench can draw.
std::vector<std::string> simulated_spools();

}  // namespace station

// A patch file (kind "patch"): one period of a cloth as spline yarns, with its measures (crimp, thickness, cover,
// mass). Numbers are written with all their digits, so that a patch that is written and read is the same patch. Keys in
// station/data/drafts/README.md.
//
// Errors: those of reader.h.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

#include "renderer/weave/patch.h"

namespace station {

renderer::YarnPatch parse_patch(const nlohmann::json& document, const std::string& source);
renderer::YarnPatch read_patch(const std::filesystem::path& file);
nlohmann::json to_json(const renderer::YarnPatch& patch);

}  // namespace station

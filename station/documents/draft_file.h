// Draft files (kind "draft"): the structure, sett, yarn sizes and thread order of a cloth; keys in
// fixtures/drafts/README.md.
//
// Errors: those of reader.h, and the line of renderer::check_draft with the file's name in front.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

#include "renderer/weave/draft.h"
#include "station/documents/reader.h"

namespace station {

renderer::Draft parse_draft(const nlohmann::json& document, const std::string& source);
renderer::Draft read_draft(const std::filesystem::path& file);  // *.wif: wif_file.h
nlohmann::json to_json(const renderer::Draft& draft);

// The numbers under `key`, where there are any, in place of the system's threads.
void replace_threads(ObjectReader& cloth, const std::string& key, renderer::YarnSystem& system);

}  // namespace station

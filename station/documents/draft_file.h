// A draft file (kind "draft"): the structure, sett, yarn sizes and thread order of a cloth; keys in
// station/data/drafts/README.md.
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
renderer::Draft read_draft(const std::filesystem::path& file);  // a *.wif file by wif_file.h
nlohmann::json to_json(const renderer::Draft& draft);

// Replaces the system's thread numbers (counted from 0) by the list under `key`, when the object has that key.
void replace_threads(ObjectReader& cloth, const std::string& key, renderer::YarnSystem& system);

}  // namespace station

// A yarn file (kind "yarn"): the parameters of the yarn baseline (renderer/scattering/yarn.h); keys in
// station/data/yarns/README.md.
//
// Errors: those of reader.h; also refused are fibers that fill more than the yarn.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

#include "renderer/scattering/yarn.h"

namespace station {

renderer::YarnParameters parse_yarn(const nlohmann::json& document, const std::string& source);
renderer::YarnParameters read_yarn(const std::filesystem::path& file);
nlohmann::json to_json(const renderer::YarnParameters& yarn);

}  // namespace station

// A fiber file (kind "fiber"): the scattering parameters of a single fiber; keys in station/data/fibers/README.md.
//
// Errors: those of reader.h.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

#include "renderer/scattering/fiber.h"

namespace station {

renderer::FiberParameters parse_fiber(const nlohmann::json& document, const std::string& source);
renderer::FiberParameters read_fiber(const std::filesystem::path& file);
nlohmann::json to_json(const renderer::FiberParameters& fiber);

}  // namespace station

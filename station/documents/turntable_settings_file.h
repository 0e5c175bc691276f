// The settings of a turntable's controller as they were before they were changed (kind "turntable-settings"), to be put
// back.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

#include "rig/turntables/grbl_settings.h"

namespace station {

struct TurntableSettings {
  std::string firmware;  // the name that it gives itself
  rig::GrblSettings settings;
};

nlohmann::json to_json(const TurntableSettings& settings);
TurntableSettings parse_turntable_settings(const nlohmann::json& document, const std::string& source);
TurntableSettings read_turntable_settings(const std::filesystem::path& file);

}  // namespace station

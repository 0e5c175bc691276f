// A fault plan (kind "faults"): what goes wrong with the simulated devices of a wire, and at which of their operations.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

#include "rig/simulated/camera_faults.h"
#include "rig/simulated/simulated_port.h"

namespace station {

struct Faults {
  rig::LineFaultPlan turntable;
  rig::CameraFaultPlan camera;
};

// Read a fault plan from its document or its file. Errors: std::runtime_error naming the file and the key.
Faults parse_faults(const nlohmann::json& document, const std::string& source);
Faults read_faults(const std::filesystem::path& file);

}  // namespace station

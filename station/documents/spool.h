// Spool files (kind "spool"): the wrapped thread, its holder and, for the simulated bench, the fibers it is made of.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "inversion/wrapped_spool.h"
#include "renderer/scattering/fiber.h"

namespace station {

// What the simulated bench draws: every thread a bundle of fibers, placed at random in its cross-section.
struct SimulatedFibers {
  int fibers_per_thread = 12;
  double fiber_radius_mm = 0.06;
  double min_gap_mm = 0.002;
  renderer::FiberParameters scattering;
  std::uint64_t seed = 1;
};

struct Spool {
  std::string name, material;
  inversion::WrappedSpool wrapping;
  std::optional<SimulatedFibers> simulation;
};

Spool parse_spool(const nlohmann::json& document, const std::string& source);
Spool read_spool(const std::filesystem::path& file);

}  // namespace station

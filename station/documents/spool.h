// Spool files (kind "spool"): the wrapped thread, its holder and, for the simulated bench, the fibers it is made of. Fabric
// files (kind "fabric"; keys in fixtures/fabrics/README.md) say of a woven sample on the black cylinder what a spool file
// says of a thread, and stand wherever a spool stands.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "inversion/wrapped_spool.h"
#include "renderer/cloth_shape.h"
#include "renderer/scattering/fiber.h"
#include "renderer/scattering/thread.h"
#include "renderer/weave/draft.h"

namespace station {

// What the simulated bench draws: every thread a bundle of fibers, placed at random in its cross-section.
struct SimulatedFibers {
  int fibers_per_thread = 12;
  double fiber_radius_mm = 0.06;
  double min_gap_mm = 0.002;
  renderer::FiberParameters scattering;
  std::uint64_t seed = 1;
};

// What a cloth is woven of; the draft numbers the threads.
struct Weave {
  renderer::Draft draft;
  std::vector<renderer::ThreadParameters> threads;
};

struct Fabric {
  renderer::CylinderShape cylinder;  // the black one, without cloth
  std::optional<Weave> weave;        // to predict it; the simulated bench draws it
};

struct Spool {
  std::string name, material;
  inversion::WrappedSpool wrapping;
  std::optional<SimulatedFibers> simulation;
  std::optional<Fabric> fabric{};  // instead of a wrapped thread
};

// `document` names no other files (read_spool_document). Errors: those of reader.h.
Spool parse_spool(const nlohmann::json& document, const std::string& source);
// The document with the drafts and threads that it names in place of their names, so that it alone is enough.
nlohmann::json read_spool_document(const std::filesystem::path& file);
Spool read_spool(const std::filesystem::path& file);

}  // namespace station

// A spool file (kind "spool"): the wrapped thread, its holder and, for the simulated bench, the fibers that the thread
// is made of. A fabric file (kind "fabric"; keys in station/data/fabrics/README.md) describes a woven sample on the
// black cylinder in the same way, and may stand wherever a spool file may.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "inversion/view/wrapped_spool.h"
#include "renderer/scattering/fiber.h"
#include "renderer/scattering/thread.h"
#include "renderer/scene/cloth_shape.h"
#include "renderer/weave/draft.h"

namespace station {

// Round plies that touch and turn about the thread's axis, each a bundle of fibers with an absorption of its own.
struct SimulatedPlies {
  std::vector<Eigen::Vector3d> sigma_a{};  // of each ply, per fiber radius, RGB
  double turn_mm = 5;                      // length of one turn along the thread
};

// Standard deviations along the thread of the logarithm of its absorption and of its diameter (a share), and over what
// length of thread their correlation falls to 1 / e.
struct SimulatedUnevenness {
  double shade = 0, diameter = 0, length_mm = 300;
};

// The fibers that the simulated bench draws: every thread is a bundle of them, placed at random in its cross-section.
struct SimulatedFibers {
  int fibers_per_thread = 12;  // of all plies together
  double fiber_radius_mm = 0.06;
  double min_gap_mm = 0.002;
  renderer::FiberParameters scattering;
  std::optional<Eigen::Vector3d> reflectance{};  // of metal, RGB, in place of eta and absorption: nothing goes through
  std::optional<SimulatedPlies> plies{};
  std::optional<SimulatedUnevenness> uneven{};  // of one bundle of dielectric fibers
  std::uint64_t seed = 1;
};

// What a cloth is woven of; the draft refers to `threads` by number.
struct Weave {
  renderer::Draft draft;
  std::vector<renderer::ThreadParameters> threads;
};

struct Fabric {
  renderer::CylinderShape cylinder;  // the black cylinder, without the cloth
  std::optional<Weave> weave;        // needed to predict the cloth; the simulated bench draws it
};

struct Spool {
  std::string name, material;
  inversion::WrappedSpool wrapping;
  std::optional<SimulatedFibers> simulation;
  std::optional<Fabric> fabric{};  // present: a cloth instead of a wrapped thread
};

// Reads a spool or fabric whose document names no other files (see read_spool_document). Errors: those of reader.h.
Spool parse_spool(const nlohmann::json& document, const std::string& source);
// The document in `file`, with the drafts and threads that it names put in place of their names, so that it stands
// alone.
nlohmann::json read_spool_document(const std::filesystem::path& file);
Spool read_spool(const std::filesystem::path& file);

}  // namespace station

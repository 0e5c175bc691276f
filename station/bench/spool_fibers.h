// The fibers that a spool is simulated with: as one bundle, even or uneven, as plies, or of metal.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "renderer/scene/scene.h"
#include "station/documents/spool.h"

namespace station {

// The fibers that the spool's threads are simulated with. Errors: std::runtime_error when it has no "simulation" part.
const SimulatedFibers& simulated_fibers(const Spool& spool);

// The same of a spool whose threads are one bundle of dielectric fibers. Errors: as above, and for any other.
const SimulatedFibers& bundled_fibers(const Spool& spool);

// Places of a thread's fibers in its section, as one bundle, mm from its axis. `flatness`: the width over the height of
// a section that is an ellipse of the thread's area. Errors: as above, and when they do not fit.
std::vector<Eigen::Vector2d> fiber_centres(const Spool& spool, std::uint64_t seed, double flatness = 1);
// The distance between the seeds of two threads. It is large, because fiber_centres also tries the seeds after its own.
inline constexpr std::uint64_t kFiberSeedStep = 1000003;
// The seeds that a spool has for its threads, from its own seed times this number on.
inline constexpr std::uint64_t kSeedsPerSpool = 1000;

// Every thread of the spool as its fibers, holder frame (mm): a set, or one for each ply or shade.
std::vector<renderer::CurveSet> spool_fibers(const Spool& spool);

}  // namespace station

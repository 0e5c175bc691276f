// Light paths through one view of the wrapped spool, traced once and then shaded with any parameters of the model that
// they were traced with (block_estimate.h).
//
// Everything in a view but the thread's parameters is fixed: cameras, light, threads. So is what a path meets. A path
// traced with some parameters (which decide how directions were drawn) therefore estimates the picture for all others
// too: its contribution is f_cos / pdf at each vertex, with f_cos evaluated anew and the recorded pdf. That is unbiased
// for any parameters and noisier the farther they are from those it was traced with; fits trace again on their way.
//
//   radiance of a block / intensity = mean over its paths of  sum_v  [prod_(u<v) f_u(next) / pdf_u]  f_v(light) w_v
//
// The events of a bundle's paths are those of its fibers, and are shaded as a fiber's.
//
// Of the light only the lamp is sampled: it is small, and no lobe is narrow enough (roughness >= 0.02) to prefer
// finding the lamp by chance. The holder's frame ends paths (view.h).
#pragma once

#include <cstdint>
#include <vector>

#include "inversion/view/blocks.h"
#include "inversion/view/view.h"
#include "renderer/scattering/thread_gradient.h"
#include "renderer/trace/ray_scene.h"

namespace inversion {

// A direction as LobeAngles of three lobes, which share the cone because there is no tilt.
struct PathDirection {
  float distance2, cos_cos;
  std::array<float, 3> from_center;
};

struct PathEvent {
  renderer::ThreadPoint<float> point;  // of a yarn: chord_length is the number of fibers on the chord
  PathDirection light, next;
  float light_weight;      // radiance per intensity / density of the direction, 1/mm^2; 0 in shadow
  float inverse_next_pdf;  // includes roulette; 0 where the path ends
};

// The number of batches that a block's paths come in, each with random numbers of its own: within a batch paths are
// low-discrepancy, so that only batches tell how far an estimate is off.
inline constexpr int kPathBatches = 4;

struct LightPaths {
  std::vector<PathEvent> events;
  std::vector<std::uint32_t> path_ends;    // index after each path's last event; paths without events have none
  std::vector<std::uint32_t> block_paths;  // index of each block's first path, and the number of paths at the end
};

// The wrapped spool as rays meet it, which is the same for all views.
renderer::RayScene spool_rays(const WrappedSpool& spool);

// The number of paths in the batches up to and including `batch`.
constexpr int batch_end(int paths, int batch) {
  return static_cast<int>(static_cast<std::int64_t>(paths) * (batch + 1) / kPathBatches);
}
// Traces `paths_per_block` paths from random positions in each block's pixels, batch after batch (batch_end).
LightPaths trace_light_paths(const renderer::RayScene& rays, const View& view, const std::vector<Block>& blocks,
                             const renderer::ScatteringModel& traced_with, int paths_per_block, std::uint64_t seed);

}  // namespace inversion

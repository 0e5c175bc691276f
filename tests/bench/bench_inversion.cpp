// Recorded path vertices shaded per second and core: what a fit spends its time on.
#include <benchmark/benchmark.h>

#include "../inversion/synthetic_spool.h"
#include "inversion/block_estimate.h"
#include "inversion/blocks.h"

namespace inversion {
namespace {

// The paths of one view, reflected or transmitted.
const LightPaths& recorded(bool transmitted) {
  static const auto record = [](double lamp_azimuth_deg) {
    const WrappedSpool spool;
    const View view = unlit_view(spool, {"view", 10, 0, lamp_azimuth_deg, 8}, 72);
    return trace_light_paths(spool_rays(spool), view, mask_blocks(view.mask, 12), known_thread(), 512, 1);
  };
  static const LightPaths reflection = record(-10), transmission = record(165);
  return transmitted ? transmission : reflection;
}

void shade(benchmark::State& state, bool transmitted, bool with_slopes) {
  const LightPaths& paths = recorded(transmitted);
  renderer::ThreadParameters thread = known_thread();
  thread.sigma_a *= 1.2;
  const auto model = block_model(thread);
  for (auto _ : state)
    for (std::size_t b = 0; b + 1 < paths.block_paths.size(); ++b)
      benchmark::DoNotOptimize(shade_block(paths, b, model, with_slopes));
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(paths.events.size()));
}

BENCHMARK_CAPTURE(shade, reflection_values, false, false);
BENCHMARK_CAPTURE(shade, reflection_slopes, false, true);
BENCHMARK_CAPTURE(shade, transmission_values, true, false);
BENCHMARK_CAPTURE(shade, transmission_slopes, true, true);

}  // namespace
}  // namespace inversion

// Recorded path vertices shaded per second and core, which is what a fit spends its time on. Also whole fits against
// the pictures' size, the light paths and the number of unknowns, with the memory that they need at most, and
// Levenberg-Marquardt against Adam.
#include <benchmark/benchmark.h>
#include <sys/resource.h>

#include <chrono>
#include <map>

#include "inversion/fit/block_estimate.h"
#include "inversion/fit/fit_views.h"
#include "inversion/fit/independent_loss.h"
#include "inversion/view/blocks.h"
#include "tests/inversion/fit/synthetic_spool.h"

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

// Of the whole program so far: give --benchmark_filter for one fit's.
double peak_mebibytes() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_maxrss) / 1024;
}

const std::vector<View>& six_views(int width_px) {
  static std::map<int, std::vector<View>> made;
  const auto found = made.find(width_px);
  if (found != made.end()) return found->second;
  return made[width_px] = photographs(WrappedSpool{}, known_thread(), width_px, 16);
}

FitOptions with_paths(ModelKind model, int paths) {
  FitOptions options{.model = model, .other_starts = {}, .paths_per_block = {paths / 4, paths}};
  options.without_bias = false;
  return options;
}

// range: pixels across, paths of the last round, model (0: thread, 16 unknowns; 1: fiber, 5).
void fit(benchmark::State& state) {
  const std::vector<View>& views = six_views(static_cast<int>(state.range(0)));
  const FitOptions options =
      with_paths(state.range(2) == 0 ? ModelKind::thread : ModelKind::fiber, static_cast<int>(state.range(1)));
  for (auto _ : state) {
    const ViewFit found = fit_views({}, views, options);
    state.counters["blocks"] = static_cast<double>(found.blocks);
    state.counters["unknowns"] = static_cast<double>(found.unknowns.size());
    state.counters["loss"] = found.loss();
  }
  state.counters["peak_MiB"] = peak_mebibytes();
}
BENCHMARK(fit)
    ->ArgNames({"width_px", "paths", "model"})
    ->ArgsProduct({{72, 144, 288}, {1024}, {0}})
    ->ArgsProduct({{144}, {256, 4096}, {0}})
    ->Args({144, 1024, 1})
    ->Unit(benchmark::kSecond)
    ->Iterations(1)
    ->UseRealTime();

// Both with their defaults, and the first round of Levenberg-Marquardt, by the loss on paths that no fit has seen.
void levenberg_marquardt_against_adam(benchmark::State& state) {
  const std::vector<View>& views = six_views(144);
  const auto timed = [&](const FitOptions& options, const std::string& name) {
    const auto started = std::chrono::steady_clock::now();
    const ViewFit found = fit_views({}, views, options);
    const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - started).count();
    state.counters[name + "_s"] = seconds;
    state.counters[name + "_loss"] = independent_loss({}, views, found, 4096, 4, 901).mean;
    return seconds;
  };
  for (auto _ : state) {
    const double whole = timed({}, "lm"), first = timed(first_rounds({}, 1), "lm_first_round");
    const double adam = timed({.solver = Solver::adam}, "adam");
    state.counters["adam_over_lm"] = adam / whole;
    state.counters["adam_over_first_round"] = adam / first;
  }
}
BENCHMARK(levenberg_marquardt_against_adam)->Unit(benchmark::kSecond)->Iterations(1)->UseRealTime();

}  // namespace
}  // namespace inversion

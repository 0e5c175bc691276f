// Rays per second of the multi-fiber simulation (radii 10 : 1, about 40 fibers, no absorption), of the plain loop over
// all circles beside it, and how both scale with cores and the number of fibers.
#include <benchmark/benchmark.h>

#include "renderer/scattering/multi_fiber.h"
#include "tests/renderer/scattering/plain_circle_tracer.h"

namespace renderer {
namespace {

constexpr int kRays = 40000;

void simulated(benchmark::State& state) {
  const MultiFiberOptions options{.theta_rad = static_cast<double>(state.range(1)) * 3.14159265 / 180,
                                  .rays = kRays,
                                  .configurations = 50,
                                  .threads = static_cast<int>(state.range(0))};
  for (auto _ : state) benchmark::DoNotOptimize(simulate_multi_fiber(options));
  state.SetItemsProcessed(state.iterations() * options.rays * options.configurations);
}
BENCHMARK(simulated)
    ->ArgNames({"threads", "theta_deg"})
    ->ArgsProduct({{1, 2}, {0, 60}})
    ->UseRealTime()
    ->Unit(benchmark::kMillisecond);

void absorbing(benchmark::State& state) {
  const MultiFiberOptions options{.sigma_a = 0.1, .rays = kRays, .configurations = 50};
  for (auto _ : state) benchmark::DoNotOptimize(simulate_multi_fiber(options));
  state.SetItemsProcessed(state.iterations() * options.rays * options.configurations);
}
BENCHMARK(absorbing)->UseRealTime()->Unit(benchmark::kMillisecond);

// Radius of the fibers in thousandths of the thread's.
void by_fiber_radius(benchmark::State& state) {
  const double radius = 0.01 * static_cast<double>(state.range(0));
  const MultiFiberOptions options{.fiber_radius = radius,
                                  .min_gap = 0.1 * radius,
                                  .max_attempts = static_cast<int>(2000 / (radius * radius)),
                                  .rays = kRays,
                                  .configurations = 4};
  MultiFiberScattering result;
  for (auto _ : state) result = simulate_multi_fiber(options);
  state.SetItemsProcessed(state.iterations() * options.rays * options.configurations);
  state.counters["fibers"] = result.mean_fibers;
  state.counters["entered"] = result.mean_entered;
}
BENCHMARK(by_fiber_radius)->Arg(200)->Arg(100)->Arg(50)->Arg(20)->UseRealTime()->Unit(benchmark::kMillisecond);

void plain_loop(benchmark::State& state) {
  const MultiFiberOptions options{.rays = 4000, .configurations = 50};
  for (auto _ : state) benchmark::DoNotOptimize(trace_circles_plainly(options));
  state.SetItemsProcessed(state.iterations() * options.rays * options.configurations);
}
BENCHMARK(plain_loop)->UseRealTime()->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace renderer

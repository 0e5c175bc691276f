// Relaxation of the ready weaves against the number of yarns: time, and time per yarn over that of the smallest.
#include <benchmark/benchmark.h>

#include <ctime>
#include <map>

#include "../renderer/weave/relaxed_cloths.h"

namespace renderer {
namespace {

void relaxation(benchmark::State& state) {
  static std::map<std::int64_t, double> first_s_per_yarn;
  const Draft draft =
      ready_weaves(static_cast<std::size_t>(state.range(1)))[static_cast<std::size_t>(state.range(0))];
  double seconds = 0;
  int steps = 0;
  for (auto _ : state) {
    const std::clock_t start = std::clock();
    const RelaxedPatch cloth = relax(draft);
    seconds += static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
    steps = cloth.report.newton_steps;
  }
  const auto yarns = static_cast<double>(ends_in_patch(draft) + picks_in_patch(draft));
  const double s_per_yarn = seconds / static_cast<double>(state.iterations()) / yarns;
  const double first = first_s_per_yarn.emplace(state.range(0), s_per_yarn).first->second;
  state.counters["yarns"] = yarns;
  state.counters["newton_steps"] = steps;
  state.counters["cost_per_yarn"] = s_per_yarn / first;
  state.SetLabel(draft.name);
}
BENCHMARK(relaxation)
    ->ArgNames({"weave", "yarns_each_way"})
    ->ArgsProduct({{0, 1, 2, 3, 4, 5}, {6, 12, 24}})
    ->Iterations(1)
    ->Unit(benchmark::kSecond)
    ->MeasureProcessCPUTime();

}  // namespace
}  // namespace renderer

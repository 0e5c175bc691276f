// The relaxation of the ready weaves against the number of yarns: processor time, and time per yarn over that of the
// smallest. Also energy and gradient, and with second derivatives, against the number of control points.
#include <benchmark/benchmark.h>

#include <ctime>
#include <map>

#include "tests/renderer/weave/relaxed_cloths.h"
#include "tests/renderer/weave/shaken_cell.h"

namespace renderer {
namespace {

void relaxation(benchmark::State& state) {
  static std::map<std::int64_t, double> first_s_per_yarn;
  const Draft draft = ready_weaves(static_cast<std::size_t>(state.range(1)))[static_cast<std::size_t>(state.range(0))];
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

void energy(benchmark::State& state) {
  const ShakenCell cell(ready_weaves(static_cast<std::size_t>(state.range(0)))[0], 0, 1, 1, 0,
                        static_cast<int>(state.range(1)));
  const Curvature curvature = state.range(2) ? Curvature::exact : Curvature::none;
  ContactList contacts;
  contacts.update(cell.model, cell.points);
  for (auto _ : state) benchmark::DoNotOptimize(cell.at(cell.points, curvature, contacts).energy);
  state.counters["points"] = cell.model.points;
  state.counters["per_point"] = benchmark::Counter(
      cell.model.points, benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}
BENCHMARK(energy)
    ->ArgNames({"yarns_each_way", "points_per_crossing", "second_derivatives"})
    ->ArgsProduct({{6, 12, 24}, {8}, {0, 1}})
    ->ArgsProduct({{6}, {4, 16, 32}, {0, 1}})
    ->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace renderer

// Evaluations and samples per second of the single-fiber model, per scalar.
#include <benchmark/benchmark.h>

#include <cmath>

#include "renderer/scattering/fiber.h"

namespace renderer {
namespace {

template <class S>
Vec3<S> direction(S theta, S phi) {
  return {std::sin(theta), std::cos(theta) * std::cos(phi), std::cos(theta) * std::sin(phi)};
}

template <class S>
const FiberModel<S>& model() {
  static const FiberModel<S> fiber({.sigma_a = {S(0.1), S(0.3), S(0.8)}});
  return fiber;
}

template <class S>
void prepare_hit(benchmark::State& state) {
  S h = S(-0.9);
  for (auto _ : state) {
    benchmark::DoNotOptimize(model<S>().lobes_at(h, direction<S>(S(0.3), S(1.2))));
    h = h > S(0.9) ? S(-0.9) : h + S(0.01);
  }
  state.SetItemsProcessed(state.iterations());
}

template <class S>
void evaluate(benchmark::State& state) {
  const auto lobes = model<S>().lobes_at(S(0.4), direction<S>(S(0.3), S(1.2)));
  Vec3<S> wi = direction<S>(S(-0.2), S(0.1));
  for (auto _ : state) {
    benchmark::DoNotOptimize(wi);
    benchmark::DoNotOptimize(lobes.evaluate(wi));
  }
  state.SetItemsProcessed(state.iterations());
}

template <class S>
void sample(benchmark::State& state) {
  const auto lobes = model<S>().lobes_at(S(0.4), direction<S>(S(0.3), S(1.2)));
  S u = 0;
  for (auto _ : state) {
    benchmark::DoNotOptimize(lobes.sample(u, S(0.3), u, S(0.7)));
    u = u > S(0.9) ? S(0) : u + S(0.01);
  }
  state.SetItemsProcessed(state.iterations());
}

BENCHMARK(prepare_hit<float>);
BENCHMARK(prepare_hit<double>);
BENCHMARK(evaluate<float>);
BENCHMARK(evaluate<double>);
BENCHMARK(sample<float>);
BENCHMARK(sample<double>);

}  // namespace
}  // namespace renderer

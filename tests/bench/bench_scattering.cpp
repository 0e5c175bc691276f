// Scattering models per second and core: one by one in float and double, many at once in packets, with derivatives.
#include <benchmark/benchmark.h>

#include <array>
#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include "renderer/scattering/fiber.h"
#include "renderer/scattering/thread.h"
#include "renderer/scattering/thread_batch.h"
#include "renderer/scattering/thread_gradient.h"
#include "renderer/scattering/yarn.h"

namespace renderer {
namespace {

constexpr std::size_t kPlaces = 4096;  // all of them together fit into the first cache

struct Places {
  std::array<float, kPlaces> h{};
  std::array<std::array<float, kPlaces>, 3> wo{}, wi{};

  template <class S>
  Vec3<S> at(const std::array<std::array<float, kPlaces>, 3>& w, std::size_t k) const {
    return {S(w[0][k]), S(w[1][k]), S(w[2][k])};
  }
};

const Places& places() {
  static const Places random = [] {
    Places p;
    std::mt19937 engine(1);
    std::uniform_real_distribution<float> uniform(-1, 1);
    for (std::size_t k = 0; k < kPlaces; ++k) {
      p.h[k] = uniform(engine);
      for (auto* w : {&p.wo, &p.wi}) {
        const float sine = uniform(engine), cosine = std::sqrt(1 - sine * sine),
                    phi = std::numbers::pi_v<float> * uniform(engine);
        (*w)[0][k] = sine, (*w)[1][k] = cosine * std::cos(phi), (*w)[2][k] = cosine * std::sin(phi);
      }
    }
    return p;
  }();
  return random;
}

template <class S>
FiberModel<S> model_of(const FiberModel<S>*) {
  return FiberModel<S>(in_scalar<S>(FiberParameters{.sigma_a = {0.1, 0.3, 0.8}}));
}
template <class S>
ThreadModel<S> model_of(const ThreadModel<S>*) {
  return ThreadModel<S>(in_scalar<S>(ThreadParameters{.sigma_a = {0.1, 0.3, 0.8}}));
}
template <class S>
YarnModel<S> model_of(const YarnModel<S>*) {
  return YarnModel<S>(in_scalar<S>(YarnParameters{.sigma_a = {0.1, 0.3, 0.8}}));
}

// Everything from offset and directions to value and density.
template <template <class> class Model, class S>
void value_and_density(benchmark::State& state) {
  const auto model = model_of(static_cast<const Model<S>*>(nullptr));
  const Places& p = places();
  for (auto _ : state)
    for (std::size_t k = 0; k < kPlaces; ++k)
      benchmark::DoNotOptimize(model.lobes_at(S(p.h[k]), p.at<S>(p.wo, k)).evaluate(p.at<S>(p.wi, k)));
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(kPlaces));
}

void thread_batch(benchmark::State& state) {
  const auto model = model_of(static_cast<const ThreadModel<float>*>(nullptr));
  const Places& p = places();
  std::array<std::array<float, kPlaces>, 4> values{};
  for (auto _ : state) {
    evaluate_batch(model, {.h = p.h, .wo = {p.wo[0], p.wo[1], p.wo[2]}, .wi = {p.wi[0], p.wi[1], p.wi[2]}},
                   {.f_cos = {values[0], values[1], values[2]}, .pdf = values[3]});
    benchmark::ClobberMemory();
  }
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(kPlaces));
}

// The lobes of one hit, to be evaluated and sampled later.
template <template <class> class Model, class S>
void prepare_hit(benchmark::State& state) {
  const auto model = model_of(static_cast<const Model<S>*>(nullptr));
  const Places& p = places();
  for (auto _ : state)
    for (std::size_t k = 0; k < kPlaces; ++k) benchmark::DoNotOptimize(model.lobes_at(S(p.h[k]), p.at<S>(p.wo, k)));
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(kPlaces));
}

template <template <class> class Model, class S>
void sample(benchmark::State& state) {
  const auto model = model_of(static_cast<const Model<S>*>(nullptr));
  const auto lobes = model.lobes_at(S(0.4), places().at<S>(places().wo, 0));
  S u = 0;
  for (auto _ : state) {
    benchmark::DoNotOptimize(lobes.sample(u, S(0.3), u, S(0.7)));
    u = u > S(0.9) ? S(0) : u + S(0.01);
  }
  state.SetItemsProcessed(state.iterations());
}

// Value and the derivatives by all parameters from what a recorded path vertex holds.
template <class S>
void thread_gradient(benchmark::State& state) {
  const auto model = model_of(static_cast<const ThreadModel<S>*>(nullptr));
  const ThreadGradientModel<S> gradient(in_scalar<S>(ThreadParameters{.sigma_a = {0.1, 0.3, 0.8}}));
  const Places& p = places();
  std::vector<LobeAngles<S>> angles;
  std::vector<ThreadPoint<S>> points;
  for (std::size_t k = 0; k < kPlaces; ++k) {
    const Vec3<S> wo = p.at<S>(p.wo, k);
    const S cosine = std::hypot(wo.y(), wo.z());
    angles.push_back(model.lobes_at(S(p.h[k]), wo).angles(p.at<S>(p.wi, k)));
    points.push_back({cosine, InnerChord<S>(S(p.h[k]), wo.x(), cosine, S(kThreadEta)).length});
  }
  for (auto _ : state)
    for (std::size_t k = 0; k < kPlaces; ++k) benchmark::DoNotOptimize(gradient.evaluate(points[k], angles[k]));
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(kPlaces));
}

BENCHMARK(value_and_density<ThreadModel, float>);
BENCHMARK(value_and_density<ThreadModel, double>);
BENCHMARK(thread_batch);
BENCHMARK(value_and_density<FiberModel, float>);
BENCHMARK(value_and_density<FiberModel, double>);
BENCHMARK(value_and_density<YarnModel, float>);
BENCHMARK(value_and_density<YarnModel, double>);
BENCHMARK(prepare_hit<ThreadModel, float>);
BENCHMARK(prepare_hit<FiberModel, float>);
BENCHMARK(sample<ThreadModel, float>);
BENCHMARK(sample<FiberModel, float>);
BENCHMARK(sample<FiberModel, double>);
BENCHMARK(thread_gradient<float>);
BENCHMARK(thread_gradient<double>);

}  // namespace
}  // namespace renderer

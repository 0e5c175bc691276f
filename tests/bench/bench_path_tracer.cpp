// Samples per second of the path tracer on the two scenes of fixtures/reference/README.md, the second as curves and as
// cloth in two scales, beside the bare first-hit rays of the same picture through Embree alone. Items are samples or
// rays; the processor time counts all cores. `noise` is the relative error of a pixel of 16 samples (root mean square,
// RGB, over the picture's mean), as bench_cycles.py prints it: the time to equal noise goes as noise^2 over samples per
// second.
#include <benchmark/benchmark.h>

#include <cmath>

#include "renderer/picture/denoise.h"
#include "renderer/trace/path_tracer.h"
#include "tests/renderer/trace/curve_scenes.h"
#include "tests/renderer/trace/embree_curves.h"

namespace renderer {
namespace {

constexpr int kSamples = 4;

CurveScene scene_named(char name) {
  return name == 'a' ? parallel_threads_scene() : plain_weave_scene();
}

double noise(const PathTracer& tracer, const Camera& camera, int max_vertices) {
  constexpr int kNoiseSamples = 16;
  cv::Mat3f a, b;
  std::uint64_t seed = 1;
  for (cv::Mat3f* picture : {&a, &b})
    *picture =
        tracer.render(camera, {.samples_per_pixel = kNoiseSamples, .seed = seed++, .max_vertices = max_vertices});
  const cv::Scalar mean = cv::mean(0.5 * (a + b));
  const double squares = cv::norm(a, b, cv::NORM_L2SQR) / (2 * 3 * static_cast<double>(a.total()));
  return std::sqrt(squares) / ((mean[0] + mean[1] + mean[2]) / 3);
}

// range: threads.
void path_tracing(benchmark::State& state, const CurveScene& scene, int max_vertices) {
  const PathTracer tracer(scene.scene);
  const int threads = static_cast<int>(state.range(0));
  for (auto _ : state) {
    benchmark::DoNotOptimize(
        tracer.render(scene.camera, {.samples_per_pixel = kSamples, .max_vertices = max_vertices, .threads = threads}));
  }
  state.SetItemsProcessed(state.iterations() * kSamples * scene.camera.width * scene.camera.height);
  state.counters["noise"] = noise(tracer, scene.camera, max_vertices);
}

// Items are pixels; `error` and `smoothed` are those of 8 samples against 256, over the mean brightness.
void smoothing(benchmark::State& state) {
  const CurveScene scene = scene_named('b');
  const Camera& camera = scene.camera;
  const PathTracer tracer(scene.scene);
  Film one = empty_film(camera.width, camera.height), other = empty_film(camera.width, camera.height);
  tracer.refine(camera, {.samples_per_pixel = 4, .seed = 1}, one);
  tracer.refine(camera, {.samples_per_pixel = 4, .seed = 2}, other);
  NoisyPicture picture = noisy_picture(one, other);
  picture.features = features_of(tracer.layers(camera, {.samples_per_pixel = 8}));
  for (auto _ : state) benchmark::DoNotOptimize(denoised(picture));
  state.SetItemsProcessed(state.iterations() * camera.width * camera.height);
  const cv::Mat3f truth = tracer.render(camera, {.samples_per_pixel = 256, .seed = 3});
  const double mean = cv::norm(cv::mean(truth)) * std::sqrt(static_cast<double>(truth.total()));
  state.counters["error"] = cv::norm(picture.mean, truth) / mean;
  state.counters["smoothed"] = cv::norm(denoised(picture), truth) / mean;
}

void bare_first_hits(benchmark::State& state, char name) {
  const CurveScene scene = scene_named(name);
  EmbreeCurves bare(scene.scene.curves, true);
  for (auto _ : state) {
    for (int row = 0; row < scene.camera.height; ++row) {
      for (int column = 0; column < scene.camera.width; ++column) {
        const CameraRay ray = ray_through(scene.camera, column + 0.2, row + 0.3);
        const Eigen::Vector3f origin = (ray.origin + 390 * ray.direction).cast<float>();
        const Eigen::Vector3f direction = ray.direction.cast<float>();
        benchmark::DoNotOptimize(bare.nearest({origin, direction}));
      }
    }
  }
  state.SetItemsProcessed(state.iterations() * scene.camera.width * scene.camera.height);
}

BENCHMARK(smoothing)->Unit(benchmark::kMillisecond)->MeasureProcessCPUTime();
BENCHMARK_CAPTURE(bare_first_hits, scene_a_one_thread, 'a')->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(bare_first_hits, scene_b_one_thread, 'b')->Unit(benchmark::kMillisecond);
#define PATH_TRACING(name, scene, vertices)              \
  BENCHMARK_CAPTURE(path_tracing, name, scene, vertices) \
      ->ArgName("threads")                               \
      ->Arg(1)                                           \
      ->Arg(2)                                           \
      ->Unit(benchmark::kMillisecond)                    \
      ->MeasureProcessCPUTime()                          \
      ->UseRealTime()
PATH_TRACING(scene_a_1_vertex, parallel_threads_scene(), 1);
PATH_TRACING(scene_a_8_vertices, parallel_threads_scene(), 8);
PATH_TRACING(scene_b_1_vertex, plain_weave_scene(), 1);
PATH_TRACING(scene_b_8_vertices, plain_weave_scene(), 8);
PATH_TRACING(scene_b_in_two_scales_1_vertex, plain_weave_cloth(), 1);
PATH_TRACING(scene_b_in_two_scales_8_vertices, plain_weave_cloth(), 8);

}  // namespace
}  // namespace renderer

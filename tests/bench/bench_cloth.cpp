// Samples per second of cloth in two scales beside the same cloth as explicit curves, flat and round a cylinder; also
// against the cloth's area and the number of yarns of a patch, which should cost nothing.
#include <benchmark/benchmark.h>

#include "renderer/trace/path_tracer.h"
#include "renderer/trace/ray_scene.h"
#include "renderer/weave/initial_patch.h"
#include "tests/renderer/trace/cloth_scenes.h"

namespace renderer {
namespace {

constexpr int kSamples = 4;

void path_tracing(benchmark::State& state, const ClothShape& shape, bool two_scale) {
  const bool flat = std::holds_alternative<SwatchShape>(shape);
  Scene scene = two_scale ? two_scale_scene(shape, satin_patch(), red_and_blue_threads())
                          : brute_force_scene(shape, satin_patch(), red_and_blue_threads());
  scene.lights = {{.center = {300, -200, 400}, .radius_mm = 30, .radiance = {100, 100, 100}, .visible = false}};
  if (!flat) scene.meshes = {body_of(CylinderShape{40.4, 171}, Eigen::Isometry3d::Identity(), {0, 0, 0})};
  const Camera camera = flat ? camera_on({60, 0, 400}, {0, 0, 0}, {0, 1, 0}, 80, 128, 128)
                             : camera_on({500, 0, 85}, {0, 0, 85}, {0, 0, 1}, 80, 128, 128);
  const PathTracer tracer(scene);
  for (auto _ : state) benchmark::DoNotOptimize(tracer.render(camera, {.samples_per_pixel = kSamples}));
  state.SetItemsProcessed(state.iterations() * kSamples * camera.width * camera.height);
  state.counters["yarn_bytes"] = static_cast<double>(RayScene(scene).yarn_bytes());
}

#define CLOTH(name, shape, two_scale) \
  BENCHMARK_CAPTURE(path_tracing, name, shape, two_scale)->Unit(benchmark::kMillisecond)->MeasureProcessCPUTime()
CLOTH(swatch_two_scale, (SwatchShape{110, 110}), true);
CLOTH(swatch_brute_force, (SwatchShape{110, 110}), false);
CLOTH(cylinder_two_scale, (CylinderShape{41, 171}), true);
CLOTH(cylinder_brute_force, (CylinderShape{41, 171}), false);

// The same 80 mm of a swatch whose side is range 0 mm, of a patch of range 1 ends and as many picks.
void size_of_cloth_and_patch(benchmark::State& state) {
  const auto side = static_cast<double>(state.range(0));
  Draft draft = plain_draft();
  draft.warp.threads.assign(static_cast<std::size_t>(state.range(1)), 0);
  draft.weft.threads.assign(static_cast<std::size_t>(state.range(1)), 1);
  const YarnPatch patch = initial_patch(draft);
  Scene scene = two_scale_scene(SwatchShape{side, side}, patch, red_and_blue_threads());
  scene.lights = {{.center = {300, -200, 400}, .radius_mm = 30, .radiance = {100, 100, 100}, .visible = false}};
  const Camera camera = camera_on({20, 0, 400}, {0, 0, 0}, {0, 1, 0}, 80, 128, 128);
  const PathTracer tracer(scene);
  for (auto _ : state) benchmark::DoNotOptimize(tracer.render(camera, {.samples_per_pixel = kSamples}));
  state.SetItemsProcessed(state.iterations() * kSamples * camera.width * camera.height);
  state.counters["yarns"] = static_cast<double>(patch.yarns.size());
  state.counters["bytes"] = static_cast<double>(tracer.memory().all());
}
BENCHMARK(size_of_cloth_and_patch)
    ->ArgNames({"side_mm", "ends"})
    ->ArgsProduct({{100, 300, 1000, 3000}, {2}})
    ->ArgsProduct({{300}, {8, 24, 48}})
    ->Unit(benchmark::kMillisecond)
    ->MeasureProcessCPUTime();

}  // namespace
}  // namespace renderer

// Rays per second through scene b of fixtures/reference/README.md: bare Embree with every yarn a curve, our own tree of
// them, the patch's own grid alone, and the grid inside the world's scene with the point that was hit (RayScene). All
// run on one core and on the same rays: those of the camera, and those that scatter from where they meet the cloth.
#include <benchmark/benchmark.h>

#include <memory>

#include "renderer/scene/patch_curves.h"
#include "renderer/trace/curve_tree.h"
#include "renderer/trace/path_vertex.h"
#include "renderer/trace/ray_scene.h"
#include "renderer/trace/yarn_grid.h"
#include "tests/renderer/trace/curve_scenes.h"
#include "tests/renderer/trace/embree_curves.h"

namespace renderer {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;

std::vector<Ray> rays_of(bool scattered) {
  const CurveScene scene = plain_weave_cloth();
  const RayScene rays(scene.scene);
  const auto models = prepare_curve_models(scattering_models(scene.scene));
  std::vector<Ray> all;
  for (int pixel = 0; pixel < scene.camera.width * scene.camera.height; pixel += 3) {
    const CameraRay camera_ray =
        ray_through(scene.camera, pixel % scene.camera.width + 0.2, pixel / scene.camera.width + 0.3);
    const Ray ray{(camera_ray.origin + 390 * camera_ray.direction).cast<float>(), camera_ray.direction.cast<float>()};
    if (!scattered) {
      all.push_back(ray);
      continue;
    }
    const auto hit = rays.intersect(ray);
    if (!hit) continue;
    Sampler sampler(1, static_cast<std::uint64_t>(pixel));
    const PathVertex vertex(*hit, -ray.direction, models);
    const Vector3f wi = vertex.sample(sampler);
    all.push_back(vertex.ray_toward(wi, sampler).ray);
  }
  return all;
}

template <class Meet>
void time_rays(benchmark::State& state, const Meet& meet) {
  const std::vector<Ray> rays = rays_of(state.range(0));
  std::size_t met = 0;
  for (auto _ : state) {
    met = 0;
    for (const Ray& ray : rays) met += meet(ray);
  }
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(rays.size()));
  state.counters["met"] = static_cast<double>(met) / static_cast<double>(rays.size());
}

void bare_embree(benchmark::State& state) {
  const CurveScene scene = plain_weave_scene();
  EmbreeCurves bare(scene.scene.curves, true);
  time_rays(state, [&](const Ray& ray) { return bare.nearest(ray).has_value(); });
}
BENCHMARK(bare_embree)->ArgName("scattered")->Arg(0)->Arg(1);

void bare_tree(benchmark::State& state) {
  const CurveScene scene = plain_weave_scene();
  const std::unique_ptr<RTCDeviceTy, decltype(&rtcReleaseDevice)> device(rtcNewDevice(nullptr), rtcReleaseDevice);
  const std::vector<CurveTree> trees = curve_trees(device.get(), scene.scene.curves);
  time_rays(state, [&](const Ray& ray) { return trees[0].nearest(ray, 1e30f).has_value(); });
  state.counters["bytes"] = static_cast<double>(trees[0].bytes());
}
BENCHMARK(bare_tree)->ArgName("scattered")->Arg(0)->Arg(1);

void bare_grid(benchmark::State& state) {
  const CurveScene scene = plain_weave_cloth();
  const YarnPatch& patch = scene.scene.cloths[0].patch;
  const YarnGrid grid({{cell_curves_of(patch, 0), 0}}, {patch.period_x_mm, patch.period_y_mm});
  const float half = 0.31f;  // of the cloth's thickness
  time_rays(state, [&](const Ray& ray) {
    // Between the planes that bound the cloth, as a shell cell would have it.
    const float up = (half - ray.origin.z()) / ray.direction.z(), down = (-half - ray.origin.z()) / ray.direction.z();
    const float begin = std::max(0.0f, std::min(up, down)), end = std::min(100.0f, std::max(up, down));
    return end > begin &&
           grid.nearest((ray.origin + begin * ray.direction).cast<double>(), ray.direction.cast<double>(), end - begin)
               .has_value();
  });
  state.counters["bytes"] = static_cast<double>(grid.bytes());
  state.counters["groups_per_cell"] = grid.groups_per_cell();
}
BENCHMARK(bare_grid)->ArgName("scattered")->Arg(0)->Arg(1);

void in_the_world(benchmark::State& state) {
  const RayScene scene(state.range(1) ? plain_weave_cloth().scene : plain_weave_scene().scene);
  time_rays(state, [&](const Ray& ray) {
    const auto hit = scene.intersect(ray);
    benchmark::DoNotOptimize(hit);
    return hit.has_value();
  });
}
BENCHMARK(in_the_world)->ArgNames({"scattered", "two_scale"})->ArgsProduct({{0, 1}, {0, 1}});

}  // namespace
}  // namespace renderer

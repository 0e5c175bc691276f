// Samples per second of the path tracer on the two scenes of fixtures/reference/README.md, beside the bare first-hit
// rays of the same picture through Embree alone. Items are samples or rays; the processor time counts all cores.
#include <benchmark/benchmark.h>
#include <embree3/rtcore.h>

#include <limits>

#include "../renderer/curve_scenes.h"
#include "renderer/path_tracer.h"

namespace renderer {
namespace {

constexpr int kSamples = 4;

CurveScene scene_named(char name) {
  return name == 'a' ? parallel_threads_scene() : plain_weave_scene();
}

void path_tracing(benchmark::State& state, char name, int max_vertices) {
  const CurveScene scene = scene_named(name);
  const PathTracer tracer(scene.scene);
  for (auto _ : state) {
    benchmark::DoNotOptimize(
        tracer.render(scene.camera, {.samples_per_pixel = kSamples, .max_vertices = max_vertices}));
  }
  state.SetItemsProcessed(state.iterations() * kSamples * scene.camera.width * scene.camera.height);
}

void bare_first_hits(benchmark::State& state, char name) {
  const CurveScene scene = scene_named(name);
  const CurveSet& curves = scene.scene.curves.front();
  const RTCDevice device = rtcNewDevice(nullptr);
  const RTCScene embree = rtcNewScene(device);
  const RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_ROUND_BSPLINE_CURVE);
  rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT4, curves.control_points.data(), 0,
                             sizeof(Eigen::Vector4f), curves.control_points.size());
  rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT, curves.segments.data(), 0,
                             sizeof(std::uint32_t), curves.segments.size());
  rtcCommitGeometry(geometry);
  rtcAttachGeometry(embree, geometry);
  rtcCommitScene(embree);
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  for (auto _ : state) {
    for (int row = 0; row < scene.camera.height; ++row) {
      for (int column = 0; column < scene.camera.width; ++column) {
        const CameraRay ray = ray_through(scene.camera, column + 0.2, row + 0.3);
        const Eigen::Vector3f origin = (ray.origin + 390 * ray.direction).cast<float>();
        const Eigen::Vector3f direction = ray.direction.cast<float>();
        RTCRayHit query{};
        query.ray.org_x = origin.x(), query.ray.org_y = origin.y(), query.ray.org_z = origin.z();
        query.ray.dir_x = direction.x(), query.ray.dir_y = direction.y(), query.ray.dir_z = direction.z();
        query.ray.tfar = std::numeric_limits<float>::infinity();
        query.ray.mask = ~0u;
        query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
        rtcIntersect1(embree, &context, &query);
        benchmark::DoNotOptimize(query);
      }
    }
  }
  state.SetItemsProcessed(state.iterations() * scene.camera.width * scene.camera.height);
  rtcReleaseGeometry(geometry);
  rtcReleaseScene(embree);
  rtcReleaseDevice(device);
}

BENCHMARK_CAPTURE(bare_first_hits, scene_a_one_thread, 'a')->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(bare_first_hits, scene_b_one_thread, 'b')->Unit(benchmark::kMillisecond);
#define PATH_TRACING(name, scene, vertices)              \
  BENCHMARK_CAPTURE(path_tracing, name, scene, vertices) \
      ->Unit(benchmark::kMillisecond)                    \
      ->MeasureProcessCPUTime()                          \
      ->UseRealTime()
PATH_TRACING(scene_a_1_vertex, 'a', 1);
PATH_TRACING(scene_a_8_vertices, 'a', 8);
PATH_TRACING(scene_b_1_vertex, 'b', 1);
PATH_TRACING(scene_b_8_vertices, 'b', 8);

}  // namespace
}  // namespace renderer

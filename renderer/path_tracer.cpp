#include "renderer/path_tracer.h"

#include <tbb/blocked_range2d.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <stdexcept>
#include <thread>

#include "renderer/lights.h"
#include "renderer/path_vertex.h"
#include "renderer/pixel_rays.h"
#include "renderer/sampler.h"

namespace renderer {
namespace {

using Eigen::Array3f;
using Eigen::Vector3d;
using Eigen::Vector3f;

constexpr int kTile = 16;  // pixels
// Shadow rays are traced with a probability in proportion to f_cos below this value, a quarter of what a uniformly
// scattering white fiber has: most faint lobes of curves are skipped, at 2 % more variance and 15 % less work.
// Diffuse surfaces are never faint in this sense: a black one would come out grainy.
constexpr float kFaintScattering = 0.02f;

// Weight of a direction drawn with density `pdf` when `other` could have drawn it too (power heuristic).
float mis_weight(float pdf, float other) {
  const float ratio = other / pdf;
  return 1 / (1 + ratio * ratio);
}

}  // namespace

struct PathTracer::Impl {
  explicit Impl(Scene scene)
      : rays(std::move(scene)), models(prepare_curve_models(scattering_models(rays.scene()))), lights(rays.scene()) {}

  // Both count the rays that they trace.
  Array3f radiance(CameraRay camera_ray, Sampler& sampler, int max_vertices, std::uint64_t& traced) const;
  Array3f direct_light(const PathVertex& vertex, Sampler& sampler, std::uint64_t& traced) const;

  RayScene rays;
  std::vector<CurveModel> models;
  Lights lights;
};

// Light sampling's share of the light that reaches a vertex directly and goes on along the path.
Array3f PathTracer::Impl::direct_light(const PathVertex& vertex, Sampler& sampler, std::uint64_t& traced) const {
  const Eigen::Vector2f u = sampler.next_2d();
  const float u_light = lights.size() > 1 ? sampler.next_1d() : 0.0f;
  const std::optional<Vector3d> about = lights.sample(vertex.position().cast<double>(), u_light, u);
  if (!about) return Array3f::Zero();
  const Vector3f start = vertex.start_toward(about->cast<float>(), sampler);
  const Vector3d origin = start.cast<double>();
  const std::optional<Vector3d> direction = lights.sample(origin, u_light, u);  // from there, hardly another
  const std::optional<LightHit> light = lights.intersect(origin, *direction, false);
  if (!light) return Array3f::Zero();  // rounding at the rim of the cone
  const Vector3f wi = direction->cast<float>();
  const ScatteringValue<float> scattering = vertex.evaluate(wi);
  if (!(scattering.f_cos.maxCoeff() > 0)) return Array3f::Zero();
  const float chance = vertex.is_curve() ? std::min(1.0f, scattering.f_cos.maxCoeff() / kFaintScattering) : 1.0f;
  if (!(sampler.next_1d() < chance)) return Array3f::Zero();
  ++traced;
  if (rays.occluded({start, wi}, static_cast<float>(light->distance))) return Array3f::Zero();
  const auto pdf = static_cast<float>(lights.pdf(origin, *direction));
  return scattering.f_cos * light->radiance * (mis_weight(pdf, scattering.pdf) / (pdf * chance));
}

// L = sum over path lengths of  prod(f_cos / pdf) * emitted; both sampling strategies meet each light once, weighted.
Array3f PathTracer::Impl::radiance(CameraRay camera_ray, Sampler& sampler, int max_vertices,
                                   std::uint64_t& traced) const {
  Array3f sum = Array3f::Zero(), throughput = Array3f::Ones();
  const bool may_hit = advance_to(rays.bounds(), camera_ray);
  Vector3d origin = camera_ray.origin, direction = camera_ray.direction;
  float scattering_pdf = 0;
  for (int vertices = 0;; ++vertices) {
    const Ray ray{origin.cast<float>(), direction.cast<float>()};
    const bool last = vertices == max_vertices;
    const std::optional<LightHit> light = lights.intersect(origin, direction, vertices == 0);
    if ((last && !light) || (vertices == 0 && !may_hit && !light)) break;
    std::optional<SurfaceHit> hit;
    if (vertices > 0 || may_hit) {
      hit = rays.intersect(ray);
      ++traced;
    }
    if (light && (!hit || light->distance < static_cast<double>(hit->distance))) {
      const float weight =
          vertices == 0 ? 1.0f : mis_weight(scattering_pdf, static_cast<float>(lights.pdf(origin, direction)));
      sum += throughput * light->radiance * weight;
      break;
    }
    if (!hit || last) break;

    const PathVertex vertex(*hit, -ray.direction, models);
    sum += throughput * direct_light(vertex, sampler, traced);
    const Vector3f wi = vertex.sample(sampler);
    const ScatteringValue<float> scattering = vertex.evaluate(wi);
    if (!(scattering.pdf > 0)) break;
    throughput *= scattering.f_cos / scattering.pdf;
    if (!(throughput.maxCoeff() > 0)) break;  // black surfaces
    scattering_pdf = scattering.pdf;
    if (vertices + 1 >= kFirstRouletteVertex) {
      const float survival = std::min(kMostSurvival, throughput.maxCoeff());
      if (!(sampler.next_1d() < survival)) break;
      throughput /= survival;
    }
    origin = vertex.start_toward(wi, sampler).cast<double>();
    direction = wi.cast<double>();
  }
  return sum;
}

PathTracer::PathTracer(Scene scene) : impl_(std::make_unique<Impl>(std::move(scene))) {}
PathTracer::~PathTracer() = default;
PathTracer::PathTracer(PathTracer&&) noexcept = default;
PathTracer& PathTracer::operator=(PathTracer&&) noexcept = default;

namespace {

// Calls work(rays, column, row) for each pixel, tiles in parallel.
template <class Work>
void for_each_pixel(const Camera& camera, int threads, const std::function<bool(double)>& progress,
                    const Work& work) {
  const int columns = (camera.width + kTile - 1) / kTile, rows = (camera.height + kTile - 1) / kTile;
  std::atomic<std::int64_t> done{0};  // pixels
  std::atomic<bool> stopped{false};
  const std::thread::id caller = std::this_thread::get_id();
  const auto draw_tile = [&](int tile) {
    const int column = tile % columns * kTile, row = tile / columns * kTile;
    const int width = std::min(kTile, camera.width - column), height = std::min(kTile, camera.height - row);
    const PixelRays rays(camera, column, row, width, height);
    for (int y = row; y < row + height && !stopped; ++y) {
      for (int x = column; x < column + width; ++x) work(rays, x, y);
      const std::int64_t finished = done += width;
      if (progress && std::this_thread::get_id() == caller &&
          !progress(static_cast<double>(finished) / (static_cast<double>(camera.width) * camera.height))) {
        stopped = true;
      }
    }
  };
  const int cores = tbb::info::default_concurrency();
  tbb::task_arena arena(threads > 0 ? std::min(threads, cores) : cores);
  arena.execute([&] { tbb::parallel_for(0, columns * rows, draw_tile, tbb::simple_partitioner()); });
  if (stopped) throw std::runtime_error("rendering was stopped on request; start it again for the whole picture");
}

}  // namespace

cv::Mat3f PathTracer::render(const Camera& camera, const RenderOptions& options) const {
  cv::Mat3f image(camera.height, camera.width, cv::Vec3f(0, 0, 0));
  if (!options.only.empty() && options.only.size() != image.size())
    throw std::runtime_error("the region to render has another size than the picture; make it height x width");
  const int max_vertices = options.max_vertices > 0 ? options.max_vertices : kMostVertices;
  std::atomic<std::uint64_t> samples{0}, all_traced{0};
  const auto draw = [&](const PixelRays& rays, int column, int row) {
    if (!options.only.empty() && options.only(row, column) == 0) return;
    Sampler sampler(options.seed, static_cast<std::uint64_t>(row) * static_cast<std::uint64_t>(camera.width) +
                                      static_cast<std::uint64_t>(column));
    Eigen::Array3d sum = Eigen::Array3d::Zero();
    std::uint64_t traced = 0;
    for (int s = 0; s < options.samples_per_pixel; ++s) {
      sampler.start_sample(static_cast<std::uint32_t>(s));
      const CameraRay ray = rays.at(column, row, sampler.next_2d());
      sum += impl_->radiance(ray, sampler, max_vertices, traced).cast<double>();
    }
    const Array3f mean = (sum / options.samples_per_pixel).cast<float>();
    image(row, column) = {mean[0], mean[1], mean[2]};
    samples += static_cast<std::uint64_t>(options.samples_per_pixel);
    all_traced += traced;
  };
  for_each_pixel(camera, options.threads, options.progress, draw);
  if (options.statistics) *options.statistics = {samples, all_traced};
  return image;
}

cv::Mat1b PathTracer::curve_coverage(const Camera& camera, int samples_per_pixel) const {
  cv::Mat1b coverage(camera.height, camera.width, uchar{0});
  const int side = std::max(1, static_cast<int>(std::ceil(std::sqrt(samples_per_pixel))));
  const auto look = [&](const PixelRays& rays, int column, int row) {
    for (int s = 0; s < side * side && coverage(row, column) == 0; ++s) {
      const Eigen::Vector2f u = (Eigen::Array2f(static_cast<float>(s % side), static_cast<float>(s / side)) + 0.5f) /
                                static_cast<float>(side);
      CameraRay ray = rays.at(column, row, u);
      if (!advance_to(impl_->rays.bounds(), ray)) continue;
      if (impl_->rays.meets_curve_first({ray.origin.cast<float>(), ray.direction.cast<float>()}))
        coverage(row, column) = 255;
    }
  };
  for_each_pixel(camera, 0, {}, look);
  return coverage;
}

}  // namespace renderer

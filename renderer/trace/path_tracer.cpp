#include "renderer/trace/path_tracer.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <stdexcept>

#include "renderer/picture/picture_tiles.h"
#include "renderer/picture/sampler.h"
#include "renderer/trace/lights.h"
#include "renderer/trace/path_vertex.h"
#include "renderer/trace/scene_walk.h"

namespace renderer {
namespace {

using Eigen::Array3f;
using Eigen::Vector3d;
using Eigen::Vector3f;

// Shadow rays are traced with a probability in proportion to f_cos below this value, a quarter of what a uniformly
// scattering white fiber has: most faint lobes of curves are skipped, at 2 % more variance and 15 % less work.
// Diffuse surfaces are never faint in this sense: a black one would come out grainy.
constexpr float kFaintScattering = 0.02f;

// Surfaces that the camera sees and that are darker than the inverse of this send less than every path on: what a black
// table reflects of its surroundings costs as much as what a white one does, and is hardly seen. What goes on has at
// most this inverse as its weight, so that no pixel of the table gets brighter than one of grey paper.
constexpr float kDarkSurfaces = 4;

// The chance with which a path goes on from its vertex of this number, counted from 1.
float survival_at(const PathVertex& vertex, int number, float throughput) {
  if (number >= kFirstRouletteVertex) return std::min(kMostSurvival, throughput);
  return number == 1 && !vertex.is_curve() ? std::min(1.0f, kDarkSurfaces * throughput) : 1.0f;
}

// Weight of a direction drawn with density `pdf` when `other` could have drawn it too (power heuristic).
float mis_weight(float pdf, float other) {
  const float ratio = other / pdf;
  return 1 / (1 + ratio * ratio);
}

}  // namespace

struct PathTracer::Impl {
  explicit Impl(Scene scene)
      : rays(std::move(scene)), models(prepare_curve_models(scattering_models(rays.scene()))), lights(rays.scene()) {}

  // Each adds the rays that it traces to `traced`.
  Array3f radiance(CameraRay camera_ray, Sampler& sampler, int max_vertices, std::uint64_t& traced) const;
  Array3f direct_light(const PathVertex& vertex, const SceneWalk& walk, Sampler& sampler) const;
  void add_samples(const PixelRays& pixel_rays, int column, int row, Sampler sampler, int goal, int max_vertices,
                   Film& film, std::uint64_t& traced) const;

  RayScene rays;
  std::vector<CurveModel> models;
  Lights lights;
};

// The light that reaches a vertex directly and goes on along the path, as far as it is light sampling's share.
Array3f PathTracer::Impl::direct_light(const PathVertex& vertex, const SceneWalk& walk, Sampler& sampler) const {
  const Eigen::Vector2f u = sampler.next_2d();
  const float u_light = lights.size() > 1 ? sampler.next_1d() : 0.0f;
  std::optional<Vector3d> direction = lights.sample(vertex.position().cast<double>(), u_light, u);
  if (!direction) return Array3f::Zero();
  const LightExit exit = lights.at_infinity() ? vertex.exit_toward(direction->cast<float>(), sampler)
                                              : vertex.exit_near(direction->cast<float>(), sampler);
  const Vector3d origin = exit.place.cast<double>();
  if (exit.place != vertex.position()) direction = lights.sample(origin, u_light, u);
  if (!direction) return Array3f::Zero();  // a light that only the vertex sees
  const std::optional<LightHit> light = lights.intersect(origin, *direction, false);
  if (!light) return Array3f::Zero();  // rounding at the rim of the cone
  const Vector3f wi = direction->cast<float>();
  ScatteringValue<float> scattering = vertex.evaluate(wi);
  scattering.f_cos *= vertex.exit_share(exit, wi);
  if (!(scattering.f_cos.maxCoeff() > 0)) return Array3f::Zero();
  const float chance = vertex.is_curve() ? std::min(1.0f, scattering.f_cos.maxCoeff() / kFaintScattering) : 1.0f;
  if (!(sampler.next_1d() < chance)) return Array3f::Zero();
  const auto [ray, lead] = vertex.ray_from(exit, wi);
  if (walk.occluded(ray, lead + static_cast<float>(light->distance), sampler)) return Array3f::Zero();
  const auto pdf = static_cast<float>(lights.pdf(origin, *direction));
  return scattering.f_cos * light->radiance * (mis_weight(pdf, scattering.pdf) / (pdf * chance));
}

// L = sum over path lengths of  prod(f_cos / pdf) * emitted; both sampling strategies meet each light once, weighted.
Array3f PathTracer::Impl::radiance(CameraRay camera_ray, Sampler& sampler, int max_vertices,
                                   std::uint64_t& traced) const {
  Array3f sum = Array3f::Zero(), throughput = Array3f::Ones();
  const bool may_hit = advance_to(rays.bounds(), camera_ray);
  Vector3d origin = camera_ray.origin, direction = camera_ray.direction;
  Ray ray{origin.cast<float>(), direction.cast<float>()};
  SceneWalk walk(rays, models);
  float scattering_pdf = 0, lead = 0;  // the ray begins `lead` before the origin
  for (int vertices = 0;; ++vertices) {
    const bool last = vertices == max_vertices;
    const std::optional<LightHit> light = lights.intersect(origin, direction, vertices == 0);
    if ((last && !light) || (vertices == 0 && !may_hit && !light)) break;
    const std::optional<SurfaceHit> hit =
        vertices > 0 || may_hit ? walk.next(ray, sampler) : std::optional<SurfaceHit>();
    if (light && (!hit || light->distance < static_cast<double>(hit->distance - lead))) {
      const float weight =
          vertices == 0 ? 1.0f : mis_weight(scattering_pdf, static_cast<float>(lights.pdf(origin, direction)));
      sum += throughput * light->radiance * weight;
      break;
    }
    if (!hit || last) break;

    const PathVertex vertex(*hit, -ray.direction, models);
    sum += throughput * direct_light(vertex, walk, sampler);
    const Vector3f wi = vertex.sample(sampler);
    const ScatteringValue<float> scattering = vertex.evaluate(wi);
    if (!(scattering.pdf > 0)) break;
    throughput *= scattering.f_cos / scattering.pdf;
    if (!(throughput.maxCoeff() > 0)) break;  // black surfaces
    scattering_pdf = scattering.pdf;
    if (const float survival = survival_at(vertex, vertices + 1, throughput.maxCoeff()); survival < 1) {
      if (!(sampler.next_1d() < survival)) break;
      throughput /= survival;
    }
    const LightExit exit = vertex.exit_toward(wi, sampler);
    const LeavingRay leaving = vertex.ray_from(exit, wi);
    ray = leaving.ray, lead = leaving.lead;
    origin = exit.place.cast<double>();
    direction = wi.cast<double>();
  }
  traced += walk.traced();
  return sum;
}

PathTracer::PathTracer(Scene scene) : impl_(std::make_unique<Impl>(std::move(scene))) {}
PathTracer::~PathTracer() = default;
PathTracer::PathTracer(PathTracer&&) noexcept = default;
PathTracer& PathTracer::operator=(PathTracer&&) noexcept = default;

namespace {

// Those of the tiles that still have pixels below their goal.
std::vector<cv::Rect> tiles_to_draw(const Film& film, const std::vector<int>& tiles) {
  std::vector<cv::Rect> parts;
  for (const int tile : tiles) {
    const cv::Rect part = tile_of(film.counts.size(), tile);
    double least = 0;
    cv::minMaxLoc(film.counts(part), &least);
    if (least < film.goals(tile)) parts.push_back(part);
  }
  return parts;
}

void check_sizes(const Camera& camera, const RenderOptions& options, const Film& film) {
  const cv::Size size(camera.width, camera.height);
  if (film.counts.size() != size)
    throw std::runtime_error("the film has another size than the picture; make it width x height of the camera");
  if (!options.only.empty() && options.only.size() != size)
    throw std::runtime_error("the region to render has another size than the picture; make it height x width");
}

}  // namespace

// Adds samples of one pixel up to its goal.
void PathTracer::Impl::add_samples(const PixelRays& pixel_rays, int column, int row, Sampler sampler, int goal,
                                   int max_vertices, Film& film, std::uint64_t& traced) const {
  cv::Vec3d& film_sum = film.sums(row, column);
  int& count = film.counts(row, column);
  Eigen::Array3d sum(film_sum[0], film_sum[1], film_sum[2]), batch = Eigen::Array3d::Zero();
  for (; count < goal; ++count) {
    sampler.start_sample(static_cast<std::uint32_t>(count));
    const CameraRay ray = pixel_rays.sample(column, row, sampler);
    const Eigen::Array3d sample = radiance(ray, sampler, max_vertices, traced).cast<double>();
    sum += sample;
    batch += sample;
    const int in_batch = count % kBatch + 1;
    if (in_batch == kBatch || count + 1 == goal) {
      film.squares(row, column) += batch.square().sum() / in_batch;
      batch.setZero();
    }
  }
  film_sum = {sum[0], sum[1], sum[2]};
}

bool PathTracer::refine(const Camera& camera, const RenderOptions& options, Film& film) const {
  check_sizes(camera, options, film);
  const int max_vertices = options.max_vertices > 0 ? options.max_vertices : kMostVertices;
  const std::vector<int> tiles = tiles_in(options.share, film.goals.cols);
  const std::uint64_t before = samples_in(film, tiles);
  std::atomic<std::uint64_t> samples{before}, all_traced{0};
  const auto draw = [&](const PixelRays& rays, int column, int row) {
    const int goal = film.goals(tile_at(film.counts.size(), column, row)), count = film.counts(row, column);
    if (count >= goal || (!options.only.empty() && options.only(row, column) == 0)) return;
    const Sampler sampler(options.seed, pixel_number(camera, column, row));
    std::uint64_t traced = 0;
    impl_->add_samples(rays, column, row, sampler, goal, max_vertices, film, traced);
    samples += static_cast<std::uint64_t>(goal - count);
    all_traced += traced;
  };
  double expected = 1, shown = 0;
  std::uint64_t asked_at = before;
  const auto go_on = [&] {
    const std::uint64_t now = samples;
    if (!options.progress || now == asked_at) return true;  // rows that were there already are no progress
    asked_at = now;
    shown = std::clamp(static_cast<double>(now) / expected, shown, 1.0);
    return options.progress(shown);
  };
  const double asked_for = options.only.empty() ? 1 : cv::mean(options.only != 0)[0] / 255;
  const auto end_pass = [&] {
    if (options.end_pass) return options.end_pass(film);
    return raise_goals(film, options.samples_per_pixel, options.noise) ? PassEnd::next : PassEnd::finished;
  };
  PassEnd end = PassEnd::next;
  while (end == PassEnd::next) {
    expected = std::max(1.0, asked_for * expected_samples(film, tiles, options.samples_per_pixel, options.noise));
    const bool drawn = for_each_pixel(camera, tiles_to_draw(film, tiles), options.threads, draw, go_on);
    end = drawn ? end_pass() : PassEnd::stopped;
  }
  if (options.statistics) *options.statistics = {samples_in(film, tiles) - before, all_traced};
  return end == PassEnd::finished;
}

cv::Mat3f PathTracer::render(const Camera& camera, const RenderOptions& options) const {
  Film film = empty_film(camera.width, camera.height);
  if (!refine(camera, options, film))
    throw std::runtime_error("rendering was stopped on request; start it again for the whole picture");
  return mean_radiance(film);
}

PictureLayers PathTracer::layers(const Camera& camera, const RenderOptions& options) const {
  constexpr int kMostLayerSamples = 16;
  return first_hit_layers(impl_->rays, impl_->models, camera, std::min(options.samples_per_pixel, kMostLayerSamples),
                          options.seed, options.threads);
}

SceneMemory PathTracer::memory() const {
  return impl_->rays.memory();
}

cv::Mat1b PathTracer::curve_coverage(const Camera& camera, int samples_per_pixel) const {
  cv::Mat1b coverage(camera.height, camera.width, uchar{0});
  const int side = std::max(1, static_cast<int>(std::ceil(std::sqrt(samples_per_pixel))));
  const auto look = [&](const PixelRays& rays, int column, int row) {
    for (int s = 0; s < side * side && coverage(row, column) == 0; ++s) {
      const Eigen::Vector2f u = (Eigen::Array2f(static_cast<float>(s % side), static_cast<float>(s / side)) + 0.5f) /
                                static_cast<float>(side);
      CameraRay ray = rays.at(column, row, u);
      if (CameraRay toward_curves = ray; !advance_to(impl_->rays.curve_bounds(), toward_curves)) continue;
      if (!advance_to(impl_->rays.bounds(), ray)) continue;
      if (impl_->rays.meets_curve_first({ray.origin.cast<float>(), ray.direction.cast<float>()}))
        coverage(row, column) = 255;
    }
  };
  for_each_pixel(camera, tiles_of({camera.width, camera.height}), 0, look, [] { return true; });
  return coverage;
}

}  // namespace renderer

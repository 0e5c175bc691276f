#include "renderer/trace/layers.h"

#include <algorithm>
#include <map>

#include "renderer/picture/film.h"
#include "renderer/picture/picture_tiles.h"
#include "renderer/picture/sampler.h"

namespace renderer {
namespace {

using Eigen::Array3f;
using Eigen::Vector3d;
using Eigen::Vector3f;

// Directions drawn for the albedo of one hit; neighbouring rays add to it.
constexpr int kAlbedoDraws = 4;

struct PixelLayers {
  Array3f albedo = Array3f::Zero();
  Vector3f normal = Vector3f::Zero();
  double depth_mm = 0;
  int hits = 0;
  std::map<std::uint32_t, int> models, yarns;  // how many rays meet each, nothing as 0
};

std::uint32_t most_frequent(const std::map<std::uint32_t, int>& counts) {
  const auto most =
      std::max_element(counts.begin(), counts.end(), [](const auto& a, const auto& b) { return a.second < b.second; });
  return most == counts.end() ? 0 : most->first;
}

Array3f albedo_of(const SurfaceHit& hit, const Vector3f& wo, const std::vector<CurveModel>& models, Sampler& sampler) {
  const PathVertex vertex(hit, wo, models);
  Array3f sum = Array3f::Zero();
  for (int i = 0; i < kAlbedoDraws; ++i) {
    const ScatteringValue<float> scattering = vertex.evaluate(vertex.sample(sampler));
    if (scattering.pdf > 0) sum += scattering.f_cos / scattering.pdf;
  }
  return sum / kAlbedoDraws;
}

// Adds what one camera ray meets.
void add_first_hit(const RayScene& scene, const std::vector<CurveModel>& models, const Camera& camera, CameraRay ray,
                   Sampler& sampler, PixelLayers& layers) {
  const bool may_hit = advance_to(scene.bounds(), ray);
  const Ray local{ray.origin.cast<float>(), ray.direction.cast<float>()};
  const std::optional<SurfaceHit> hit = may_hit ? scene.intersect(local) : std::nullopt;
  std::uint32_t model = 0, yarn = 0;
  if (hit) {
    const auto* curve = std::get_if<CurvePoint>(&hit->point);
    const Vector3f& position = curve ? curve->position : std::get<MeshPoint>(hit->point).position;
    const Vector3d from_eye = position.cast<double>() - camera.world_from_camera.translation();
    layers.depth_mm += from_eye.dot(camera.world_from_camera.linear().col(2));
    layers.normal += curve ? curve->normal : std::get<MeshPoint>(hit->point).normal;
    layers.albedo += albedo_of(*hit, -local.direction, models, sampler);
    ++layers.hits;
    if (curve) model = curve->curve_set + 1;
    if (const std::optional<YarnPlace> place = scene.yarn_at(local)) yarn = packed_yarn(*place);
  }
  ++layers.models[model];
  ++layers.yarns[yarn];
}

}  // namespace

std::vector<cv::Mat1f> features_of(const PictureLayers& layers) {
  std::vector<cv::Mat1f> features(6);
  cv::split(layers.albedo, features.data());
  cv::split(layers.normal, features.data() + 3);
  // Where there is nothing, no depth stands out.
  cv::Mat1f depth_mm = layers.depth_mm.clone();
  cv::Mat seen, unseen;
  cv::compare(layers.cover, 0, seen, cv::CMP_GT);
  cv::bitwise_not(seen, unseen);
  depth_mm.setTo(cv::mean(depth_mm, seen), unseen);
  features.insert(features.end(), {depth_mm, layers.cover});
  return features;
}

std::uint32_t packed_yarn(const YarnPlace& yarn) {
  constexpr int kHalf = 1 << 25;
  const auto number = static_cast<std::uint32_t>(yarn.number + kHalf) & (2u * kHalf - 1);
  const std::uint32_t id = (yarn.group & 31u) << 27 | (yarn.weft ? 1u << 26 : 0u) | number;
  return id == 0 ? 1 : id;
}

PictureLayers first_hit_layers(const RayScene& scene, const std::vector<CurveModel>& models, const Camera& camera,
                               int samples_per_pixel, std::uint64_t seed, int threads) {
  const cv::Size size(camera.width, camera.height);
  PictureLayers layers{.albedo = cv::Mat3f(size, cv::Vec3f::all(0)),
                       .normal = cv::Mat3f(size, cv::Vec3f::all(0)),
                       .depth_mm = cv::Mat1f(size, 0.0f),
                       .cover = cv::Mat1f(size, 0.0f),
                       .model = cv::Mat1i(size, 0),
                       .yarn = cv::Mat1i(size, 0)};
  const auto draw = [&](const PixelRays& rays, int column, int row) {
    Sampler sampler(seed, pixel_number(camera, column, row));
    PixelLayers pixel;
    for (int s = 0; s < samples_per_pixel; ++s) {
      sampler.start_sample(static_cast<std::uint32_t>(s));
      const CameraRay ray = rays.sample(column, row, sampler);
      add_first_hit(scene, models, camera, ray, sampler, pixel);
    }
    const auto hits = static_cast<float>(std::max(1, pixel.hits));
    const Array3f albedo = pixel.albedo / hits;
    const Vector3f normal = pixel.normal / hits;
    layers.albedo(row, column) = {albedo[0], albedo[1], albedo[2]};
    layers.normal(row, column) = {normal[0], normal[1], normal[2]};
    layers.depth_mm(row, column) = static_cast<float>(pixel.depth_mm / std::max(1, pixel.hits));
    layers.cover(row, column) = static_cast<float>(pixel.hits) / static_cast<float>(samples_per_pixel);
    layers.model(row, column) = static_cast<int>(most_frequent(pixel.models));
    layers.yarn(row, column) = static_cast<int>(most_frequent(pixel.yarns));
  };
  for_each_pixel(camera, tiles_of(size), threads, draw, [] { return true; });
  return layers;
}

}  // namespace renderer

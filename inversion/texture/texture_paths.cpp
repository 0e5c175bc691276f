#include "inversion/texture/texture_paths.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

#include "renderer/picture/sampler.h"
#include "renderer/trace/path_vertex.h"
#include "renderer/weave/patch_measures.h"

namespace inversion {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3f;
using renderer::CurvePoint;

constexpr double kMargin = 20;       // periods of cloth round the repeat that paths begin in
constexpr double kTracedWith = 0.2;  // absorption: bright cloth keeps most of its paths, dark cloth finds its own

// A scene of the endless patch in its own plane, as far as paths get from the patch at its origin.
renderer::Scene scene_of(const TexturedCloth& cloth) {
  renderer::Cloth flat{.patch = cloth.patch, .threads = {}};
  for (renderer::ThreadParameters thread : cloth.threads) {
    thread.sigma_a.setConstant(kTracedWith);
    flat.threads.push_back(thread);
  }
  const Vector2d period(cloth.patch.period_x_mm, cloth.patch.period_y_mm);
  for (const auto& [x, y] : {std::pair(-kMargin, -kMargin), std::pair(kMargin + 1, -kMargin),
                             std::pair(kMargin + 1, kMargin + 1), std::pair(-kMargin, kMargin + 1)}) {
    const Vector2d at = period.cwiseProduct(Vector2d(x, y));
    flat.surface.vertices.push_back({at.x(), at.y(), 0});
    flat.surface.normals.push_back({0, 0, 1});
    flat.surface.patch_mm.push_back(at);
  }
  flat.surface.triangles = {{0, 1, 2}, {0, 2, 3}};
  renderer::Scene scene;
  scene.cloths = {std::move(flat)};
  return scene;
}

class CrossingRecorder {
 public:
  explicit CrossingRecorder(const TexturedCloth& cloth)
      : crossing_mm_(cloth.crossing_mm()),
        above_mm_(1 + renderer::surface_range(cloth.patch).high_mm),
        rays_(scene_of(cloth)),
        models_(renderer::prepare_curve_models(renderer::scattering_models(rays_.scene()))) {
    for (const renderer::ThreadParameters& thread : cloth.threads)
      threads_.push_back(renderer::in_scalar<float>(thread));
  }

  // Records one path of the crossing at `from` (column, row from below); returns false when it has no value.
  bool record(const Eigen::Vector2i& from, renderer::Sampler& sampler, std::vector<TextureEvent>& events) const {
    const Vector2d at = (from.cast<double>() + sampler.next_2d().cast<double>()).cwiseProduct(crossing_mm_);
    renderer::Ray ray{Eigen::Vector3d(at.x(), at.y(), above_mm_).cast<float>(), {0, 0, -1}};
    float throughput = 1;
    for (int vertex = 0; vertex < renderer::kMostVertices; ++vertex) {
      const std::optional<renderer::SurfaceHit> hit = rays_.intersect(ray);
      if (!hit) return true;
      const renderer::PathVertex scattering(*hit, -ray.direction, models_);
      const Vector3f next = scattering.sample(sampler);
      const renderer::ScatteringValue<float> value = scattering.evaluate(next);
      if (!(value.pdf > 0)) return false;
      float weight = 1 / value.pdf;
      throughput *= value.f_cos.maxCoeff() * weight;
      if (vertex + 1 >= renderer::kFirstRouletteVertex) {
        const float survival = std::min(renderer::kMostSurvival, throughput);
        if (!(sampler.next_1d() < survival)) return false;
        weight /= survival, throughput /= survival;
      }
      events.push_back(
          event_at(std::get<CurvePoint>(hit->point), -ray.direction, scattering.lobe_densities(next), weight, from));
      ray = scattering.ray_toward(next, sampler).ray;
    }
    return false;
  }

 private:
  TextureEvent event_at(const CurvePoint& curve, const Vector3f& wo_world, const renderer::Lanes<float>& densities,
                        float weight, const Eigen::Vector2i& from) const {
    const renderer::BasicThreadParameters<float>& thread = threads_[curve.curve_set];
    const Vector3f wo = renderer::local_from_world(curve) * wo_world;
    const float cosine = std::hypot(wo.y(), wo.z()), h = renderer::offset_in_section(curve, wo_world);
    const std::array<float, 3> lambda = renderer::thread_lobe_energies(thread, cosine);
    const float chord = renderer::InnerChord<float>(h, wo.x(), cosine, static_cast<float>(renderer::kThreadEta)).length;
    const auto [first, second] = thread.transmittance_powers;
    const Vector2d place = curve.position.head<2>().cast<double>().cwiseQuotient(crossing_mm_);
    const Eigen::Vector2i moved = Eigen::Vector2d(place.array().floor()).cast<int>() - from;
    TextureEvent event{.reflected = {},
                       .tt = lambda[1] * densities[1] * weight,
                       .trt = lambda[2] * densities[2] * weight,
                       .chord_tt = chord * static_cast<float>(first),
                       .chord_trt = chord * static_cast<float>(second),
                       .right = static_cast<std::int16_t>(moved.x()),
                       .up = static_cast<std::int16_t>(moved.y())};
    for (int c = 0; c < 3; ++c)
      event.reflected[static_cast<std::size_t>(c)] = thread.lambda0_rgb[c] * lambda[0] * densities[0] * weight;
    return event;
  }

  Vector2d crossing_mm_;
  double above_mm_;
  renderer::RayScene rays_;
  std::vector<renderer::CurveModel> models_;
  std::vector<renderer::BasicThreadParameters<float>> threads_;
};

}  // namespace

std::vector<CrossingPaths> trace_crossing_paths(const TexturedCloth& cloth, int paths_per_crossing,
                                                std::uint64_t seed) {
  const CrossingRecorder recorder(cloth);
  std::vector<CrossingPaths> crossings(static_cast<std::size_t>(cloth.crossings.prod()));
  tbb::parallel_for(std::size_t{0}, crossings.size(), [&](std::size_t i) {
    CrossingPaths& paths = crossings[i];
    const auto number = static_cast<int>(i);
    const Eigen::Vector2i from(number % cloth.crossings.x(), cloth.crossings.y() - 1 - number / cloth.crossings.x());
    renderer::Sampler sampler(seed, i);
    for (; paths.traced < paths_per_crossing; ++paths.traced) {
      sampler.start_sample(static_cast<std::uint32_t>(paths.traced));
      if (recorder.record(from, sampler, paths.events))
        paths.ends.push_back(static_cast<std::uint32_t>(paths.events.size()));
      else
        paths.events.resize(paths.ends.back());
    }
  });
  return crossings;
}

CrossingPaths those_that_mix(const CrossingPaths& paths) {
  CrossingPaths mixing{.traced = paths.traced};
  for (std::size_t i = 0; i < paths.count(); ++i) {
    const auto begin = paths.events.begin() + paths.ends[i], end = paths.events.begin() + paths.ends[i + 1];
    if (std::all_of(begin, end, [](const TextureEvent& e) { return e.right == 0 && e.up == 0; })) continue;
    mixing.events.insert(mixing.events.end(), begin, end);
    mixing.ends.push_back(static_cast<std::uint32_t>(mixing.events.size()));
  }
  return mixing;
}

}  // namespace inversion

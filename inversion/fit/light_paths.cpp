#include "inversion/fit/light_paths.h"

#include <tbb/parallel_for.h>

#include <algorithm>

#include "renderer/picture/sampler.h"
#include "renderer/trace/lights.h"
#include "renderer/trace/path_vertex.h"
#include "renderer/trace/scene_walk.h"

namespace inversion {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;
using renderer::CurveLobes;

PathDirection stored(const renderer::LobeAngles<float>& at) {
  return {at.distance2[0], at.cos_cos[0], {at.from_center[0], at.from_center[1], at.from_center[2]}};
}

// Traces the paths of one view; the lamp has unit intensity.
class PathRecorder {
 public:
  PathRecorder(const renderer::RayScene& rays, const View& view, const renderer::ScatteringModel& traced_with)
      : rays_(rays),
        traced_with_(traced_with),
        models_(renderer::prepare_curve_models({traced_with})),
        lights_({.lights = {unit_lamp(view.light)}}) {}

  void record(renderer::CameraRay camera_ray, renderer::Sampler& sampler, std::vector<PathEvent>& events) const {
    if (!renderer::advance_to(rays_.bounds(), camera_ray)) return;
    renderer::Ray ray{camera_ray.origin.cast<float>(), camera_ray.direction.cast<float>()};
    renderer::SceneWalk walk(rays_, models_);
    float throughput = 1;
    for (int vertex = 0; vertex < renderer::kMostVertices && throughput > 0; ++vertex) {
      const std::optional<renderer::SurfaceHit> hit = walk.next(ray, sampler);
      const auto* curve = hit ? std::get_if<renderer::CurvePoint>(&hit->point) : nullptr;
      if (!curve) {
        if (vertex > 0) events.back().inverse_next_pdf = 0;  // nothing there: nothing to shade
        return;
      }
      ray = record_event(*curve, walk, ray.direction, vertex + 1 >= renderer::kFirstRouletteVertex, sampler, throughput,
                         events);
    }
  }

 private:
  static renderer::SphereLight unit_lamp(NearLight light) {
    light.intensity.setOnes();
    return sphere_light(light);
  }

  // Appends the event; returns the ray that goes on and scales its throughput, which is 0 where the path ends.
  renderer::Ray record_event(const renderer::CurvePoint& curve, const renderer::SceneWalk& walk,
                             const Vector3f& arriving, bool roulette, renderer::Sampler& sampler, float& throughput,
                             std::vector<PathEvent>& events) const {
    const Eigen::Matrix3f frame = renderer::local_from_world(curve);
    const Vector3f wo = frame * -arriving;
    const CurveLobes<float> lobes = renderer::lobes_at(models_.front(), curve, frame, -arriving);
    const renderer::ThreadExits exits(renderer::exit_of(models_.front()), curve, -arriving);
    PathEvent event{};
    event.point = point_at(renderer::viewing_offset(wo), wo);
    event.light_weight = record_light(curve.position, walk, exits, frame, lobes, sampler, event.light);

    const Eigen::Vector2f u = sampler.next_2d(), u_angles = sampler.next_2d();
    const Vector3f next = lobes.sample(u.x(), u.y(), u_angles.x(), u_angles.y());
    event.next = stored(lobes.angles(next));
    const renderer::ScatteringValue<float> scattering = lobes.evaluate(next);
    float weight = scattering.pdf > 0 ? scattering.f_cos.maxCoeff() / scattering.pdf : 0.0F;
    event.inverse_next_pdf = scattering.pdf > 0 ? 1 / scattering.pdf : 0.0F;
    if (roulette) {
      const float survival = std::min(renderer::kMostSurvival, throughput * weight);
      if (sampler.next_1d() < survival) {
        event.inverse_next_pdf /= survival;
        weight /= survival;
      } else {
        event.inverse_next_pdf = weight = 0;
      }
    }
    throughput *= weight;
    events.push_back(event);
    const Vector3f onwards = (frame.transpose() * next).normalized();
    return exits.ray(exits.toward(onwards, sampler), onwards).ray;
  }

  renderer::ThreadPoint<float> point_at(float h, const Vector3f& wo) const {
    const float cosine = std::hypot(wo.y(), wo.z());
    return {cosine, std::visit([&](const auto& model) { return way_inside(model, h, wo.x(), cosine); }, traced_with_)};
  }

  // What absorbs on the way through a curve: fibers of a yarn, the chord of what is one body.
  static float way_inside(const renderer::YarnParameters& yarn, float h, float, float) {
    return static_cast<float>(renderer::fibers_on_chord(yarn.fiber_count, yarn.radius_ratio, static_cast<double>(h)));
  }
  static float way_inside(const renderer::FiberParameters& fiber, float h, float sine, float cosine) {
    return renderer::InnerChord<float>(h, sine, cosine, static_cast<float>(fiber.eta)).length;
  }
  static float way_inside(const renderer::BundleParameters& bundle, float h, float sine, float cosine) {
    return way_inside(bundle.fiber, h, sine, cosine);
  }
  static float way_inside(const renderer::ThreadParameters&, float h, float sine, float cosine) {
    return renderer::InnerChord<float>(h, sine, cosine, static_cast<float>(renderer::kThreadEta)).length;
  }

  float record_light(const Vector3f& position, const renderer::SceneWalk& walk, const renderer::ThreadExits& exits,
                     const Eigen::Matrix3f& frame, const CurveLobes<float>& lobes, renderer::Sampler& sampler,
                     PathDirection& direction) const {
    const Eigen::Vector2f u = sampler.next_2d();
    const renderer::LightExit exit = exits.near(lights_.sample(position.cast<double>(), 0, u)->cast<float>(), sampler);
    const Vector3d origin = exit.place.cast<double>();
    const std::optional<Vector3d> wi = lights_.sample(origin, 0, u);
    const std::optional<renderer::LightHit> light = lights_.intersect(origin, *wi, false);
    if (!light) return 0;  // rounding at the rim of the cone
    direction = stored(lobes.angles(frame * wi->cast<float>()));
    const float share = exits.share(exit, wi->cast<float>());
    const auto [ray, lead] = exits.ray(exit, wi->cast<float>());
    if (!(share > 0) || walk.occluded(ray, lead + static_cast<float>(light->distance), sampler)) return 0;
    return share * light->radiance[0] / static_cast<float>(lights_.pdf(origin, *wi));
  }

  const renderer::RayScene& rays_;
  renderer::ScatteringModel traced_with_;
  std::vector<renderer::CurveModel> models_;  // the one
  renderer::Lights lights_;
};

struct BlockPaths {
  std::vector<PathEvent> events;
  std::vector<std::uint32_t> ends;
};

BlockPaths trace_block(const PathRecorder& recorder, const View& view, const Block& block, int count,
                       std::uint64_t seed, std::size_t number) {
  BlockPaths traced;
  int batch = -1, first = 0;
  std::optional<renderer::Sampler> stream;
  for (int i = 0; i < count; ++i) {
    while (batch < 0 || i >= batch_end(count, batch)) {
      first = i;
      ++batch;
      stream.emplace(seed, number * kPathBatches + static_cast<std::size_t>(batch));
    }
    renderer::Sampler& sampler = *stream;
    sampler.start_sample(static_cast<std::uint32_t>(i - first));
    const auto chosen = static_cast<std::size_t>(sampler.next_1d() * static_cast<float>(block.pixels.size()));
    const cv::Point& pixel = block.pixels[std::min(chosen, block.pixels.size() - 1)];
    const Eigen::Vector2f u = sampler.next_2d();
    const renderer::CameraRay ray = renderer::ray_through(view.camera, pixel.x + static_cast<double>(u.x()) - 0.5,
                                                          pixel.y + static_cast<double>(u.y()) - 0.5);
    recorder.record(ray, sampler, traced.events);
    traced.ends.push_back(static_cast<std::uint32_t>(traced.events.size()));
  }
  return traced;
}

}  // namespace

renderer::RayScene spool_rays(const WrappedSpool& spool) {
  return renderer::RayScene(view_scene(spool, renderer::ThreadParameters{}, NearLight{}));
}

LightPaths trace_light_paths(const renderer::RayScene& rays, const View& view, const std::vector<Block>& blocks,
                             const renderer::ScatteringModel& traced_with, int paths_per_block, std::uint64_t seed) {
  const PathRecorder recorder(rays, view, traced_with);
  std::vector<BlockPaths> traced(blocks.size());
  tbb::parallel_for(std::size_t{0}, blocks.size(), [&](std::size_t b) {
    traced[b] = trace_block(recorder, view, blocks[b], paths_per_block, seed, b);
  });
  LightPaths paths;
  for (const BlockPaths& block : traced) {
    const auto first = static_cast<std::uint32_t>(paths.events.size());
    paths.block_paths.push_back(static_cast<std::uint32_t>(paths.path_ends.size()));
    paths.events.insert(paths.events.end(), block.events.begin(), block.events.end());
    for (std::uint32_t end : block.ends) paths.path_ends.push_back(first + end);
  }
  paths.block_paths.push_back(static_cast<std::uint32_t>(paths.path_ends.size()));
  return paths;
}

}  // namespace inversion

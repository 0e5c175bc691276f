#include "renderer/trace/scene_walk.h"

#include <algorithm>
#include <limits>

namespace renderer {

SceneWalk::SceneWalk(const RayScene& scene, const std::vector<CurveModel>& models) : scene_(&scene), models_(&models) {
  if (std::ranges::any_of(models, [](const auto& model) { return std::holds_alternative<BundleModel>(model); }))
    inside_ = std::make_unique<Bundles>();
}

const BundleModel* SceneWalk::bundle_of(const SurfaceHit& hit) const {
  const auto* curve = std::get_if<CurvePoint>(&hit.point);
  return curve ? std::get_if<BundleModel>(&(*models_)[curve->curve_set]) : nullptr;
}

std::optional<SurfaceHit> SceneWalk::next(const Ray& ray, float distance, Bundles& inside, Sampler& sampler) const {
  const bool overlap = scene_->yarns_overlap();
  float before = 0;
  for (Ray rest = ray;;) {
    std::optional<SurfaceHit> fiber;
    std::optional<BundleWalk>* of_fiber = nullptr;
    Bundles gone = inside;  // each where its own next fiber is
    for (std::size_t i = 0; i < inside.size(); ++i) {
      if (!gone[i]) continue;
      std::optional<SurfaceHit> found = gone[i]->next(rest);
      if (found && (!fiber || found->distance < fiber->distance)) fiber = found, of_fiber = &gone[i];
    }
    std::optional<SurfaceHit> hit;
    const float most = std::min(distance - before, fiber ? fiber->distance : std::numeric_limits<float>::infinity());
    if (!fiber || overlap) {
      ++traced_;
      hit = scene_->intersect(rest, most);
    }
    if (!hit && (!fiber || fiber->distance > most)) return std::nullopt;
    const auto keep_those_around = [&](const Eigen::Vector3f& place) {
      for (std::optional<BundleWalk>& bundle : inside)
        if (bundle && (!overlap || !bundle->contains(place))) bundle.reset();
    };
    if (!hit) {
      if (overlap) {
        const std::size_t number = static_cast<std::size_t>(of_fiber - gone.data());
        inside[number].reset();
        keep_those_around(std::get<CurvePoint>(fiber->point).position);
        inside[number] = *of_fiber;
      } else {
        inside = gone;
      }
      fiber->distance += before;
      return fiber;
    }
    const BundleModel* thread = bundle_of(*hit);
    if (!thread) {
      inside = {};
      hit->distance += before;
      return hit;
    }
    const auto& entry = std::get<CurvePoint>(hit->point);
    keep_those_around(entry.position);
    const auto free = std::ranges::find_if(inside, [](const auto& bundle) { return !bundle; });
    (free == inside.end() ? inside.front() : *free).emplace(thread->sections(), entry, sampler);
    before += hit->distance;
    rest.origin = entry.position;
  }
}

std::optional<SurfaceHit> SceneWalk::next(const Ray& ray, Sampler& sampler) {
  if (!inside_) {
    ++traced_;
    return scene_->intersect(ray);
  }
  return next(ray, std::numeric_limits<float>::infinity(), *inside_, sampler);
}

bool SceneWalk::occluded(const Ray& ray, float distance, Sampler& sampler) const {
  if (!inside_) {
    ++traced_;
    return scene_->occluded(ray, distance);
  }
  Bundles inside = *inside_;
  return next(ray, distance, inside, sampler).has_value();
}

}  // namespace renderer

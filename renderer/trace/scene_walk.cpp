#include "renderer/trace/scene_walk.h"

#include <algorithm>

namespace renderer {

SceneWalk::SceneWalk(const RayScene& scene, const std::vector<CurveModel>& models)
    : scene_(&scene), models_(&models), has_bundles_(std::ranges::any_of(models, [](const CurveModel& model) {
        return std::holds_alternative<BundleModel>(model);
      })) {}

const BundleModel* SceneWalk::bundle_of(const SurfaceHit& hit) const {
  const auto* curve = std::get_if<CurvePoint>(&hit.point);
  return curve ? std::get_if<BundleModel>(&(*models_)[curve->curve_set]) : nullptr;
}

std::optional<SurfaceHit> SceneWalk::next(const Ray& ray, Sampler& sampler) {
  if (bundle_) {
    if (const std::optional<SurfaceHit> fiber = bundle_->next(ray)) return fiber;
    bundle_.reset();
  }
  float before = 0;
  for (Ray rest = ray;;) {
    ++traced_;
    std::optional<SurfaceHit> hit = scene_->intersect(rest);
    if (!hit) return std::nullopt;
    const BundleModel* thread = bundle_of(*hit);
    before += hit->distance;
    if (!thread) {
      hit->distance = before;
      return hit;
    }
    const auto& entry = std::get<CurvePoint>(hit->point);
    bundle_.emplace(thread->sections(), entry, sampler);
    rest.origin = entry.position;
    if (std::optional<SurfaceHit> fiber = bundle_->next(rest)) {
      fiber->distance += before;
      return fiber;
    }
    bundle_.reset();
  }
}

bool SceneWalk::occluded(const Ray& ray, float distance, Sampler& sampler) const {
  if (bundle_) {
    BundleWalk here = *bundle_;
    if (const auto fiber = here.next(ray); fiber && fiber->distance < distance) return true;
  }
  if (!has_bundles_) {
    ++traced_;
    return scene_->occluded(ray, distance);
  }
  float left = distance;
  for (Ray rest = ray;;) {
    ++traced_;
    const std::optional<SurfaceHit> hit = scene_->intersect(rest);
    if (!hit || hit->distance >= left) return false;
    const BundleModel* thread = bundle_of(*hit);
    if (!thread) return true;
    const auto& entry = std::get<CurvePoint>(hit->point);
    left -= hit->distance;
    rest.origin = entry.position;
    BundleWalk bundle(thread->sections(), entry, sampler);
    if (const auto fiber = bundle.next(rest); fiber && fiber->distance < left) return true;
  }
}

}  // namespace renderer

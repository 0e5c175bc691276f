// What the rays of one light path meet, one after the other, in a scene some of whose curves may be bundles of fibers
// (bundle_walk.h): surfaces, curves and, in place of a bundle's thread, the fibers of a bundle drawn for the path.
#pragma once

#include <optional>
#include <vector>

#include "renderer/picture/sampler.h"
#include "renderer/trace/bundle_walk.h"
#include "renderer/trace/path_vertex.h"
#include "renderer/trace/ray_scene.h"

namespace renderer {

class SceneWalk {
 public:
  // Both must outlive it.
  SceneWalk(const RayScene& scene, const std::vector<CurveModel>& models);

  // What the ray meets first; it starts where the last one ended.
  std::optional<SurfaceHit> next(const Ray& ray, Sampler& sampler);
  // True when anything lies within `distance` along a ray that starts where the last one of next() ended.
  bool occluded(const Ray& ray, float distance, Sampler& sampler) const;

  // Rays traced through the scene so far.
  std::uint64_t traced() const { return traced_; }

 private:
  const BundleModel* bundle_of(const SurfaceHit& hit) const;

  const RayScene* scene_;
  const std::vector<CurveModel>* models_;
  bool has_bundles_;
  std::optional<BundleWalk> bundle_;  // that the path is in
  mutable std::uint64_t traced_ = 0;
};

}  // namespace renderer

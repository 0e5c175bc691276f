// What the rays of one light path meet, one after the other, in a scene some of whose curves may be bundles of fibers
// (bundle_walk.h): surfaces, curves and, in place of a bundle's thread, the fibers of a bundle drawn for the path.
// Where yarns lie in each other (RayScene::yarns_overlap) the fibers of all of them are there.
#pragma once

#include <array>
#include <memory>
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
  // Bundles that the path is in: one, or where yarns are pressed into each other several.
  using Bundles = std::array<std::optional<BundleWalk>, 4>;

  const BundleModel* bundle_of(const SurfaceHit& hit) const;
  // What the ray meets first within `distance`, from among the bundles that it is in, which are then those that it is
  // in there.
  std::optional<SurfaceHit> next(const Ray& ray, float distance, Bundles& inside, Sampler& sampler) const;

  const RayScene* scene_;
  const std::vector<CurveModel>* models_;
  std::unique_ptr<Bundles> inside_;  // none where no curve is a bundle: setting it up costs as much as a ray
  mutable std::uint64_t traced_ = 0;
};

}  // namespace renderer

// One cloth inside Embree: a user geometry of shell cells (cloth_shell.h) in the world's scene, and the patch's own grid of
// yarns (yarn_grid.h), which a ray meets inside a cell.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "renderer/cloth_shell.h"
#include "renderer/ray_scene.h"
#include "renderer/yarn_grid.h"

struct RTCIntersectFunctionNArguments;
struct RTCOccludedFunctionNArguments;

namespace renderer {

// What a ray met, in the frame of the patch's cell it was in. Valid after a query whose nearest hit is on a cloth.
struct ClothHit {
  std::uint32_t cell = 0, yarns = 0, segment = 0;
  float u = 0;
  Eigen::Vector3f hit_normal = Eigen::Vector3f::Zero();
  Ray ray{};                                       // there, not unit
  float distance = 0;                              // along `ray`
  Eigen::Vector3d tile = Eigen::Vector3d::Zero();  // endless patch = there + tile
};

class ClothGeometry {
 public:
  // Its hits carry curve set `first_curve_set` + thread. Errors: those of make_shell; a yarn of a thread that is not
  // among the cloth's threads; an absorption texture without texels, or for threads of another scattering model.
  ClothGeometry(const Cloth& cloth, std::uint32_t first_curve_set);
  ClothGeometry(const ClothGeometry&) = delete;
  ClothGeometry& operator=(const ClothGeometry&) = delete;

  // Adds the cloth as the scene's next geometry. The scene calls back into this object, which must outlive it.
  void attach_to(RTCDeviceTy* device, RTCSceneTy* scene) const;
  // A hit in world coordinates.
  CurvePoint point_at(const ClothHit& hit) const;
  YarnPlace yarn_at(const ClothHit& hit) const { return places_.at(hit.yarns, hit.segment, hit.tile); }
  // Control points and segments that reach into one cell of the patch: all that is stored of the yarns.
  std::size_t yarn_bytes() const;
  std::size_t shell_bytes() const;
  std::size_t grid_bytes() const { return grid_.bytes(); }

 private:
  void intersect(const RTCIntersectFunctionNArguments& arguments) const;
  void occluded(const RTCOccludedFunctionNArguments& arguments) const;

  ClothShell shell_;
  std::uint32_t first_curve_set_;
  std::vector<ColumnYarns> yarns_;  // of one thread and section
  YarnGrid grid_;
  YarnPlaces places_;
  std::optional<AbsorptionTexture> absorption_;
};

}  // namespace renderer

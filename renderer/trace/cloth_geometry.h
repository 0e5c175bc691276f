// One cloth inside Embree: a user geometry of shell cells (cloth_shell.h) in the world's scene, and the patch's own
// grid of yarns (yarn_grid.h), which a ray meets inside a cell.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "renderer/scene/fiber_detail.h"
#include "renderer/trace/cloth_shell.h"
#include "renderer/trace/ray_hit.h"
#include "renderer/trace/yarn_grid.h"
#include "renderer/trace/yarn_places.h"

struct RTCDeviceTy;
struct RTCIntersectFunctionNArguments;
struct RTCOccludedFunctionNArguments;
struct RTCSceneTy;

namespace renderer {

class ClothGeometry {
 public:
  // The cloth's hits carry curve set `first_curve_set` + thread. Errors: those of make_shell; std::runtime_error for a
  // yarn of a thread that is not among the cloth's threads, and for an absorption texture without texels or for threads
  // of another scattering model.
  ClothGeometry(const Cloth& cloth, std::uint32_t first_curve_set);
  ClothGeometry(const ClothGeometry&) = delete;
  ClothGeometry& operator=(const ClothGeometry&) = delete;

  // Adds the cloth as the scene's next geometry. The scene calls back into this object, which must outlive it.
  void attach_to(RTCDeviceTy* device, RTCSceneTy* scene) const;
  // The point of a hit in world coordinates.
  CurvePoint point_at(const ClothHit& hit) const;
  // The yarn of a hit, with group 0.
  YarnPlace yarn_at(const ClothHit& hit) const { return places_.at(hit.yarns, hit.segment, hit.tile); }
  // Bytes of the control points and segments that reach into one cell of the patch: all that is stored of the yarns.
  std::size_t yarn_bytes() const;
  std::size_t shell_bytes() const;
  std::size_t grid_bytes() const { return grid_.bytes(); }

 private:
  ClothGeometry(const Cloth& cloth, const FlyawayCurves& flyaways, std::uint32_t first_curve_set);
  // The fiber of a point that is still in the patch's frame, at `place` of the endless patch.
  FiberAt fiber_of(const ClothHit& hit, const Eigen::Vector3d& place, const CurvePoint& point) const;
  void intersect(const RTCIntersectFunctionNArguments& arguments) const;
  void occluded(const RTCOccludedFunctionNArguments& arguments) const;

  ClothShell shell_;
  std::uint32_t first_curve_set_;
  std::vector<ColumnYarns> yarns_;  // each of one thread and section
  YarnGrid grid_;
  YarnPlaces places_;
  std::optional<AbsorptionTexture> absorption_;
  std::optional<FiberDetail> fibers_;
  std::vector<bool> has_fibers_;  // by thread
};

}  // namespace renderer

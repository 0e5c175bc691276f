// One cloth inside Embree: a user geometry of shell cells (cloth_shell.h) in the world's scene, and a small scene of its
// own with one column of the patch, through which a ray is followed column by column.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <optional>
#include <vector>

#include "renderer/cloth_shell.h"
#include "renderer/ray_scene.h"

struct RTCIntersectFunctionNArguments;
struct RTCOccludedFunctionNArguments;

namespace renderer {

// What a ray met, in the frame of the column it was in. Valid after a query whose nearest hit is on a cloth.
struct ClothHit {
  std::uint32_t cell = 0, yarns = 0, segment = 0;
  float u = 0;
  Eigen::Vector3f hit_normal = Eigen::Vector3f::Zero();
  Ray ray{};                                       // in the column, not unit
  float distance = 0;                              // along `ray`
  Eigen::Vector3d tile = Eigen::Vector3d::Zero();  // patch = column + tile
};

class ClothGeometry {
 public:
  // Its hits carry curve set `first_curve_set` + thread. Errors: those of make_shell; a yarn of a thread that is not
  // among the cloth's threads.
  ClothGeometry(const Cloth& cloth, std::uint32_t first_curve_set, RTCDeviceTy* device);
  ClothGeometry(const ClothGeometry&) = delete;
  ClothGeometry& operator=(const ClothGeometry&) = delete;

  // Adds the cloth as the scene's next geometry. The scene calls back into this object, which must outlive it.
  void attach_to(RTCDeviceTy* device, RTCSceneTy* scene) const;
  // A hit in world coordinates.
  CurvePoint point_at(const ClothHit& hit) const;
  YarnPlace yarn_at(const ClothHit& hit) const { return places_.at(hit.yarns, hit.segment, hit.tile); }
  // Control points and segments of the column: all that is stored of the yarns.
  std::size_t yarn_bytes() const;
  std::size_t shell_bytes() const;

 private:
  template <class Visit>
  void follow(const ShellCell& cell, const Eigen::Vector3d& origin, const Eigen::Vector3d& direction, RaySpan within,
              const Visit& visit) const;
  void intersect(const RTCIntersectFunctionNArguments& arguments) const;
  void occluded(const RTCOccludedFunctionNArguments& arguments) const;

  ClothShell shell_;
  Eigen::Vector2d period_mm_;
  double margin_mm_;
  std::uint32_t first_curve_set_;
  struct Yarns {
    CurveSet curves;  // round; the cloth's are stretched
    std::uint32_t thread;
    Eigen::Vector3f stretch;
  };
  std::vector<Yarns> yarns_;  // of one thread and section
  std::shared_ptr<RTCSceneTy> column_;
  YarnPlaces places_;
};

}  // namespace renderer

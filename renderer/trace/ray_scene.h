// A Scene for rays: nearest hits and occlusion, with the surface frame at a hit. Curves are in trees of their own
// (curve_tree.h), everything else is inside Embree.
//
// Curves are seen from outside only: a ray that is inside a curve leaves it without a hit, because the scattering
// models describe everything that happens between entering and leaving a fiber. Cloth (cloth_shell.h) is met as the
// curves it stands for.
#pragma once

#include <Eigen/Geometry>
#include <atomic>
#include <limits>
#include <memory>
#include <optional>
#include <variant>
#include <vector>

#include "renderer/scene/scene.h"
#include "renderer/trace/curve_tree.h"
#include "renderer/trace/ray_hit.h"
#include "renderer/trace/yarn_places.h"

struct RTCDeviceTy;
struct RTCRayHit;
struct RTCSceneTy;

namespace renderer {

class ClothGeometry;
struct ClothQuery;

// What a scene takes of the memory, in bytes.
struct SceneMemory {
  std::size_t yarns = 0;     // control points and segments of cloths and curves, with what hits of them need
  std::size_t surfaces = 0;  // shapes of cloths and bodies, cells of shells
  std::size_t trees = 0;     // trees of curves, grids of yarns, and all that Embree has taken for itself
  std::size_t all() const { return yarns + surfaces + trees; }
};

class RayScene {
 public:
  explicit RayScene(Scene scene);

  // The nearest hit within `distance` along the ray, if there is one.
  std::optional<SurfaceHit> intersect(const Ray& ray, float distance = std::numeric_limits<float>::infinity()) const;
  // True when anything lies within `distance` along the ray.
  bool occluded(const Ray& ray, float distance) const;
  // The yarn that a ray meets first; none when it meets nothing, or a body before any yarn.
  std::optional<YarnPlace> yarn_at(const Ray& ray) const;
  // True when the ray's first hit is on a curve, also on one of a cloth.
  bool meets_curve_first(const Ray& ray) const;

  // Whether yarns of a cloth lie in each other, as those of scaled heights do. Explicit curves are not asked.
  bool yarns_overlap() const { return yarns_overlap_; }

  // Bytes of the control points and segments of all yarns and fibers, which are the same for every size of a two-scale
  // cloth. Embree's tree and the cells of surfaces come on top.
  std::size_t yarn_bytes() const;
  SceneMemory memory() const;

  const Eigen::AlignedBox3d& bounds() const { return bounds_; }
  // A box that holds all curves, those of cloths too. A ray that misses it meets none.
  const Eigen::AlignedBox3d& curve_bounds() const { return curve_bounds_; }
  const Scene& scene() const { return scene_; }

 private:
  void add_mesh(const TriangleMesh& mesh);
  bool has_surfaces() const { return !scene_.meshes.empty() || !scene_.cloths.empty(); }
  // Embree numbers the meshes, and after them the cloths.
  bool is_cloth(std::uint32_t geometry) const { return geometry >= scene_.meshes.size(); }
  std::size_t number_of_cloth(std::uint32_t geometry) const { return geometry - scene_.meshes.size(); }
  std::optional<CurveTree::Hit> nearest_curve(const Ray& ray, float distance) const;
  // What Embree meets: a mesh or a cloth, whose hit is in `query`.
  std::optional<RTCRayHit> nearest_surface(const Ray& ray, float distance, ClothQuery& query) const;
  MeshPoint mesh_point(std::uint32_t mesh, std::uint32_t triangle, float u, float v, const Ray& ray) const;

  Scene scene_;
  std::shared_ptr<std::atomic<std::int64_t>> embree_bytes_;  // outlives the device, which counts them
  std::vector<std::vector<std::uint32_t>> first_segments_;   // first segment of each curve, by curve set
  std::shared_ptr<RTCDeviceTy> device_;
  std::vector<CurveTree> trees_;
  std::vector<std::shared_ptr<const ClothGeometry>> cloths_;  // outlive the scene, which calls them
  std::shared_ptr<RTCSceneTy> embree_;
  bool yarns_overlap_ = false;
  Eigen::AlignedBox3d bounds_;        // empty for a scene without surfaces
  Eigen::AlignedBox3d curve_bounds_;  // empty for a scene without curves
};

}  // namespace renderer

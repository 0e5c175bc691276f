// A Scene inside Embree: nearest hits and occlusion, with the surface frame at a hit.
//
// Curves are seen from outside only: a ray that is inside a curve leaves it without a hit, because the scattering
// models describe everything that happens between entering and leaving a fiber. Cloth (cloth_shell.h) is met as the
// curves it stands for.
#pragma once

#include <Eigen/Geometry>
#include <atomic>
#include <memory>
#include <optional>
#include <variant>
#include <vector>

#include "renderer/scene.h"
#include "renderer/yarn_places.h"

struct RTCDeviceTy;
struct RTCSceneTy;

namespace renderer {

class ClothGeometry;

struct Ray {
  Eigen::Vector3f origin;
  Eigen::Vector3f direction;  // unit
};

struct CurvePoint {
  std::uint32_t curve_set;  // number of the scattering model, as in scattering_models()
  Eigen::Vector3f
      position;  // just below the surface, where scattered rays start: they cannot meet the same spot again
  Eigen::Vector3f tangent, normal;  // unit, perpendicular to each other; normal points outwards
  float radius;                     // from the curve's axis to `position`; of a flattened yarn that of the round one
  const cv::Vec3f* absorption = nullptr;  // texel of the cloth's AbsorptionTexture there, if it has one
};

struct MeshPoint {
  std::uint32_t mesh;
  Eigen::Vector3f position;
  Eigen::Vector3f normal;  // unit, towards the ray's origin
  Eigen::Array3f albedo;
  const ReflectanceFactor* reflectance_factor;  // none: Lambertian
};

struct SurfaceHit {
  float distance;  // mm
  std::variant<CurvePoint, MeshPoint> point;
};

// What a scene takes of the memory, in bytes.
struct SceneMemory {
  std::size_t yarns = 0;     // control points and segments of cloths and curves, with what hits of them need
  std::size_t surfaces = 0;  // shapes of cloths and bodies, cells of shells
  std::size_t trees = 0;     // all that Embree has taken for itself
  std::size_t all() const { return yarns + surfaces + trees; }
};

class RayScene {
 public:
  explicit RayScene(Scene scene);

  std::optional<SurfaceHit> intersect(const Ray& ray) const;
  // True when anything lies within `distance` along the ray.
  bool occluded(const Ray& ray, float distance) const;
  // The yarn that a ray meets first; none when it meets none, or a body before.
  std::optional<YarnPlace> yarn_at(const Ray& ray) const;
  // True when the first hit is on a curve, be it a cloth's.
  bool meets_curve_first(const Ray& ray) const;

  // Control points and segments of all yarns and fibers: the same for every size of a two-scale cloth. Embree's tree
  // and the cells of surfaces come on top.
  std::size_t yarn_bytes() const;
  SceneMemory memory() const;

  const Eigen::AlignedBox3d& bounds() const { return bounds_; }
  const Scene& scene() const { return scene_; }

 private:
  void add_mesh(const TriangleMesh& mesh);
  MeshPoint mesh_point(std::uint32_t mesh, std::uint32_t triangle, float u, float v, const Ray& ray) const;

  Scene scene_;
  std::shared_ptr<std::atomic<std::int64_t>> embree_bytes_;  // outlives the device, which counts them
  std::vector<std::vector<std::uint32_t>> first_segments_;   // of each curve of each curve set
  std::shared_ptr<RTCDeviceTy> device_;
  std::vector<std::shared_ptr<const ClothGeometry>> cloths_;  // outlive the scene, which calls them
  std::shared_ptr<RTCSceneTy> embree_;
  Eigen::AlignedBox3d bounds_;  // empty for a scene without surfaces
};

}  // namespace renderer

// A scene as the path tracer sees it: thread or fiber curves, cloth, diffuse meshes and lights, in one world frame
// (mm).
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <functional>
#include <opencv2/core.hpp>
#include <optional>
#include <variant>
#include <vector>

#include "renderer/scattering/bundle.h"
#include "renderer/scattering/fiber.h"
#include "renderer/scattering/thread.h"
#include "renderer/scattering/yarn.h"
#include "renderer/scene/environment_map.h"
#include "renderer/weave/patch.h"

namespace renderer {

// How a curve scatters, one of a closed set: the parameters of a fiber, a thread or a yarn, whose models (FiberModel,
// ThreadModel, YarnModel) evaluate and sample them, or of a bundle, whose fibers rays meet in its place.
using ScatteringModel = std::variant<FiberParameters, ThreadParameters, YarnParameters, BundleParameters>;

// Round uniform cubic B-spline curves that share one scattering model.
struct CurveSet {
  std::vector<Eigen::Vector4f> control_points{};  // x, y, z, radius (mm)
  std::vector<std::uint32_t> segments{};          // index of the first of each segment's four control points
  ScatteringModel scattering = FiberParameters{};
  // Planes (n, d) in the curves' frame: what has n . x > d of any is cut off, and the cut ends are open.
  std::vector<Eigen::Vector4f> cut{};
  // World from the curves' frame. Where it stretches, the curves have elliptical sections.
  Eigen::Affine3f placed = Eigen::Affine3f::Identity();

  // Appends one curve of at least two points. Its end points are mirrored outwards, so that the B-spline starts at
  // the first point and ends at the last with a tangent that is not zero; n points make n - 1 segments.
  void add_clamped_curve(const std::vector<Eigen::Vector4f>& points);
};

// The brightness of a real matt surface over that of a Lambertian one of the same albedo, by the cosines of the angles
// of incidence and of viewing and of the azimuth between the two (1 = light and viewer on the same side).
using ReflectanceFactor = std::function<double(double cos_theta_i, double cos_theta_o, double cos_phi)>;

// Triangles with a matt, optionally textured, two-sided surface.
struct TriangleMesh {
  std::vector<Eigen::Vector3f> vertices{};  // mm
  std::vector<std::array<std::uint32_t, 3>> triangles{};
  std::vector<Eigen::Vector2f> texture_coordinates{};      // per vertex, (0, 0) = top left of the texture; may be empty
  cv::Mat3f albedo = cv::Mat3f(1, 1, cv::Vec3f(0, 0, 0));  // looked up at the nearest texel (crisp tags)
  ReflectanceFactor reflectance_factor{};                  // none: Lambertian
};

// A smooth surface that says where each place of an endless patch (patch.h) lies: the patch's plane z = 0. Triangles
// turn counter-clockwise both in the patch and seen from its face (+z), and share vertices where the cloth goes on.
struct ClothSurface {
  std::vector<Eigen::Vector3d> vertices{};  // mm, world
  std::vector<Eigen::Vector3d> normals{};   // per vertex, unit: where the patch's +z points
  std::vector<Eigen::Vector2d> patch_mm{};  // per vertex: x, y in the endless patch
  std::vector<std::array<std::uint32_t, 3>> triangles{};
};

// Absorption that differs from place to place of an endless patch and replaces that of its threads: a picture in the
// cloth. Where two yarns cross, both have the absorption of that place.
struct AbsorptionTexture {
  cv::Mat3f sigma_a{};                                 // per thread radius, RGB; the first row has the largest y
  Eigen::Vector2d texel_mm = Eigen::Vector2d::Ones();  // in the patch; the lower left corner is at its origin
  Eigen::Vector2i texel_at(const Eigen::Vector2d& patch_mm) const;  // column, row; it repeats without end
};

// What is seen of the fibers of a cloth's threads close by (fiber_detail.h). Bundles have none: their fibers are there.
struct FiberDetail {
  double twist_rad = 0;     // of the fibers on a thread's surface against its axis
  double spread_rad = 0;    // standard deviation of their directions about that
  double shade = 0;         // standard deviation of their absorption, as a share of the thread's
  double width_mm = 0.015;  // of a fiber
  std::uint64_t seed = 1;
};

// How a fiber on the surface of a thread differs from the thread.
struct FiberAt {
  float turn_rad = 0, lift_rad = 0;  // its direction from the thread's axis: about the normal, and towards it
  float shade = 1;                   // its absorption over the thread's
};

// Fibers that stand out of a cloth's yarns (fiber_detail.h).
struct Flyaways {
  double per_mm = 1;     // of yarn
  double length_mm = 1;  // mean
  double diameter_mm = 0.015;
  FiberParameters fiber{};
  std::uint64_t seed = 1;
};

// Cloth in two scales: one patch, repeated without end over a surface and ending at its border. Memory does not grow
// with the number of repeats. Cloth as explicit curves: cloth_shape.h.
struct Cloth {
  ClothSurface surface{};
  YarnPatch patch{};
  std::vector<ScatteringModel> threads{};         // by thread index of the patch's yarns
  std::optional<AbsorptionTexture> absorption{};  // only where all threads are ThreadParameters
  std::optional<FiberDetail> fibers{};
  std::optional<Flyaways> flyaways{};
};

// An emitting sphere; irradiance at distance d facing it: radiance * beam_factor * pi * radius^2 / d^2.
struct SphereLight {
  Eigen::Vector3d center = Eigen::Vector3d::Zero();
  double radius_mm = 1.0;
  Eigen::Vector3d radiance = Eigen::Vector3d::Ones();  // RGB
  bool visible = true;                                 // seen by camera rays
  // A beam: radiance falls off as cos^beam_exponent of the angle from beam_axis (unit) to the point that sees it, and
  // is zero behind. Exponent 0: the same in all directions. [Queau et al. 2018, doi 10.1007/s10851-017-0761-1]
  Eigen::Vector3d beam_axis = -Eigen::Vector3d::UnitZ();
  double beam_exponent = 0.0;
};

// The share of the light's radiance that its beam leaves in the direction of `point`.
double beam_factor(const SphereLight& light, const Eigen::Vector3d& point);

// An emitting rectangle, bright on the side from which edge_x turns counter-clockwise to edge_y; irradiance far away on
// its axis: radiance * area / d^2.
struct RectangleLight {
  Eigen::Vector3d center = Eigen::Vector3d::Zero();
  Eigen::Vector3d edge_x = Eigen::Vector3d::UnitX(),
                  edge_y = Eigen::Vector3d::UnitY();   // whole sides, perpendicular, mm
  Eigen::Vector3d radiance = Eigen::Vector3d::Ones();  // RGB
  bool visible = true;                                 // seen by camera rays
};

struct Scene {
  std::vector<CurveSet> curves{};
  std::vector<TriangleMesh> meshes{};
  std::vector<SphereLight> lights{};
  std::optional<EnvironmentLight> surroundings{};
  std::vector<Cloth> cloths{};
  std::vector<RectangleLight> rectangles{};
};

// The models of all curves, in the order in which hits number them (CurvePoint::curve_set): the curve sets, then the
// threads of each cloth with the fiber of its flyaways.
std::vector<ScatteringModel> scattering_models(const Scene& scene);

}  // namespace renderer

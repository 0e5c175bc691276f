// What the path tracer sees: thread or fiber curves, diffuse meshes and spherical lights, in one world frame (mm).
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <opencv2/core.hpp>
#include <variant>
#include <vector>

#include "renderer/scattering/fiber.h"
#include "renderer/scattering/thread.h"

namespace renderer {

// Closed set: how a curve scatters. Every alternative is a plain struct with free evaluate / sample / density
// functions.
using ScatteringModel = std::variant<FiberParameters, ThreadParameters>;

// Round uniform cubic B-spline curves that share one scattering model.
struct CurveSet {
  std::vector<Eigen::Vector4f> control_points{};  // x, y, z, radius (mm)
  std::vector<std::uint32_t> segments{};          // index of the first of each segment's four control points
  ScatteringModel scattering = FiberParameters{};

  // Appends one curve of at least two points. Its end points are mirrored outwards, so that the B-spline starts at
  // the first point and ends at the last with a tangent that is not zero; n points make n - 1 segments.
  void add_clamped_curve(const std::vector<Eigen::Vector4f>& points);
};

// Triangles with a Lambertian, optionally textured, two-sided surface.
struct TriangleMesh {
  std::vector<Eigen::Vector3f> vertices{};  // mm
  std::vector<std::array<std::uint32_t, 3>> triangles{};
  std::vector<Eigen::Vector2f> texture_coordinates{};  // per vertex, (0, 0) = top left of the texture; may be empty
  cv::Mat3f albedo = cv::Mat3f(1, 1, cv::Vec3f(0, 0, 0));  // looked up at the nearest texel (crisp tags)
};

// Uniformly emitting sphere; irradiance at distance d facing it: radiance * pi * radius^2 / d^2.
struct SphereLight {
  Eigen::Vector3d center = Eigen::Vector3d::Zero();
  double radius_mm = 1.0;
  Eigen::Vector3d radiance = Eigen::Vector3d::Ones();  // RGB
  bool visible = true;                                 // seen by camera rays
};

struct Scene {
  std::vector<CurveSet> curves{};
  std::vector<TriangleMesh> meshes{};
  std::vector<SphereLight> lights{};
};

}  // namespace renderer

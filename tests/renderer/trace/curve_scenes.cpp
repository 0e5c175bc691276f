#include "tests/renderer/trace/curve_scenes.h"

#include <cmath>
#include <numbers>
#include <vector>

#include "renderer/scene/cloth_shape.h"

namespace renderer {
namespace {

Camera camera_with_frame_width(double width_mm) {
  Camera camera = look_at({0, 0, 400}, {0, 0, 0}, {0, 1, 0});
  camera.width = 512, camera.height = 384;
  camera.fx = camera.fy = 512 * 400 / width_mm;
  camera.cx = 255.5, camera.cy = 191.5;
  return camera;
}

SphereLight light() {
  const double radiance = 10 * 400 * 400 / (std::numbers::pi * 25);
  return {.center = 400 * Eigen::Vector3d(0, std::sin(std::numbers::pi / 6), std::cos(std::numbers::pi / 6)),
          .radius_mm = 5,
          .radiance = Eigen::Vector3d::Constant(radiance)};
}

FiberParameters material() {
  return {.sigma_a = {0.1, 0.3, 0.8}};
}

constexpr int kSegments = 4;  // per crossing

// The height of control point k of yarn i. The yarn is a uniform cubic B-spline through samples of a cosine; its
// control points are the samples, amplified.
double control_height(bool warp, int i, int k) {
  const double amplitude = 0.15 * 6 / (4 + 2 * std::cos(std::numbers::pi / kSegments)),
               t = static_cast<double>(k) / kSegments;
  return (warp ? -1 : 1) * amplitude * std::cos(std::numbers::pi * (t - 0.5) + std::numbers::pi * i);
}

}  // namespace

CurveScene parallel_threads_scene() {
  CurveSet threads{.scattering = material()};
  for (int i = 0; i < 50; ++i) {
    const float y = static_cast<float>((i - 24.5) * 0.3);
    std::vector<Eigen::Vector4f> points;  // short pieces are met in less time
    for (int x = -30; x <= 30; x += 4) points.emplace_back(static_cast<float>(x), y, 0, 0.15f);
    threads.add_clamped_curve(points);
  }
  return {{.curves = {threads}, .lights = {light()}}, camera_with_frame_width(20)};
}

CurveScene plain_weave_scene() {
  constexpr int kYarns = 200;
  CurveSet yarns{.scattering = material()};
  for (const bool warp : {false, true}) {
    for (int i = 0; i < kYarns; ++i) {
      const double across = (i - 99.5) * 0.45;
      const auto first = static_cast<std::uint32_t>(yarns.control_points.size());
      for (int k = -1; k <= kYarns * kSegments + 1; ++k) {
        const double along = -45 + 0.45 * k / kSegments, z = control_height(warp, i, k);
        const Eigen::Vector3d point = warp ? Eigen::Vector3d(across, along, z) : Eigen::Vector3d(along, across, z);
        yarns.control_points.emplace_back(point.x(), point.y(), point.z(), 0.15);
        if (k + 2 <= kYarns * kSegments) yarns.segments.push_back(first + static_cast<std::uint32_t>(k + 1));
      }
    }
  }
  return {{.curves = {yarns}, .lights = {light()}}, camera_with_frame_width(90)};
}

CurveScene plain_weave_cloth() {
  YarnPatch patch{.name = "scene b", .period_x_mm = 0.9, .period_y_mm = 0.9};
  for (const bool warp : {true, false}) {
    for (int i = 0; i < 2; ++i) {
      Yarn yarn{.warp = warp, .radius_mm = 0.15};
      const double across = (i + 0.5) * 0.45;
      for (int k = 0; k < 2 * kSegments; ++k) {
        const double along = 0.45 * k / kSegments, z = control_height(warp, i, k);
        yarn.control_points.push_back(warp ? Eigen::Vector3d(across, along, z) : Eigen::Vector3d(along, across, z));
      }
      patch.yarns.push_back(yarn);
    }
  }
  const ClothSurface surface = surface_of(SwatchShape{90, 90}, patch, Eigen::Isometry3d::Identity());
  return {{.lights = {light()}, .cloths = {{surface, patch, {material()}}}}, camera_with_frame_width(90)};
}

}  // namespace renderer

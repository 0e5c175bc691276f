// Light sampling beside a lamp that is as near as threads are to each other, against a quadrature: directions over the
// whole lamp, places over the whole section, no sampling strategy and no ray tracer.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <numbers>

#include "renderer/scattering/exit_offsets.h"
#include "renderer/trace/path_tracer.h"
#include "tests/renderer/trace/cloth_scenes.h"

namespace renderer {
namespace {

using Eigen::Array3d;
using Eigen::Vector3d;

constexpr double kRadius_mm = 0.25;

// The density of the places of exit per radian of the section, for light that goes along wi (unit; y and z span the
// section). The thread lies along x; `entry` is the unit normal where the ray came in.
double exit_density(ThreadExit rule, const Vector3d& entry, const Vector3d& wo, const Vector3d& wi, double angle) {
  const double wi_angle = std::atan2(wi.z(), wi.y()), from_middle = angle - wi_angle;
  const double facing = std::cos(from_middle);
  if (facing <= 0) return 0;
  if (rule == ThreadExit::far_side) return facing / 2;
  const double offset_in = -std::sin(std::atan2(entry.z(), entry.y()) - std::atan2(wo.z(), wo.y()));
  const double azimuth = wi_angle - std::atan2(wo.z(), wo.y());
  return facing *
         static_cast<double>(simulated_exit_offsets().density(
             static_cast<float>(offset_in), static_cast<float>(azimuth), static_cast<float>(std::sin(from_middle))));
}

// Whether a ray meets the sphere.
bool meets(const Vector3d& from, const Vector3d& wi, const SphereLight& lamp) {
  const Vector3d to = lamp.center - from;
  const double along = to.dot(wi);
  return along > 0 && to.squaredNorm() - along * along < lamp.radius_mm * lamp.radius_mm;
}

// What a ray from unit direction wo that meets the thread at `entry` sees of the lamp by one scattering.
Array3d light_of(const ThreadParameters& thread, const Vector3d& entry, const Vector3d& wo, const SphereLight& lamp) {
  const ThreadModel<double> model(thread);
  const Eigen::Matrix3d frame = (Eigen::Matrix3d() << Vector3d::UnitX().transpose(),
                                 entry.cross(Vector3d::UnitX()).transpose(), entry.transpose())
                                    .finished();
  const Vector3d wo_local = frame * wo;
  const auto lobes = model.lobes_at(-wo_local.y() / std::hypot(wo_local.y(), wo_local.z()), wo_local);
  // All directions in which any place sees the lamp: a cap about the direction to its middle.
  const Vector3d middle = lamp.center.normalized(), side = middle.unitOrthogonal(), up = middle.cross(side);
  const double reach = std::asin(std::min(1.0, (lamp.radius_mm + kRadius_mm * 1.6) / lamp.center.norm()));
  constexpr int kTheta = 40, kPhi = 48, kPlaces = 120;
  Array3d sum = Array3d::Zero();
  for (int i = 0; i < kTheta; ++i)
    for (int j = 0; j < kPhi; ++j) {
      const double theta = reach * (i + 0.5) / kTheta, phi = 2 * std::numbers::pi * (j + 0.5) / kPhi;
      const Vector3d wi = std::cos(theta) * middle + std::sin(theta) * (std::cos(phi) * side + std::sin(phi) * up);
      const double solid_angle = std::sin(theta) * reach / kTheta * 2 * std::numbers::pi / kPhi;
      double seen = 0;
      if (thread.exit == ThreadExit::far_side && entry.dot(wi) >= 0) {
        seen = meets(kRadius_mm * entry, wi, lamp);
      } else {
        const double slope = std::clamp(-wo.x() / std::hypot(wo.y(), wo.z()), -0.5, 0.5);
        for (int k = 0; k < kPlaces; ++k) {
          const double angle = 2 * std::numbers::pi * (k + 0.5) / kPlaces;
          const double density = exit_density(thread.exit, entry, wo, wi, angle);
          if (density == 0) continue;
          Vector3d place = kRadius_mm * Vector3d(0, std::cos(angle), std::sin(angle));
          if (thread.exit == ThreadExit::wandering) place.x() = slope * (place - kRadius_mm * entry).tail<2>().norm();
          if (meets(place, wi, lamp)) seen += density * 2 * std::numbers::pi / kPlaces;
        }
      }
      if (seen > 0) sum += lobes.evaluate(frame * wi).f_cos * (seen * solid_angle);
    }
  return sum * lamp.radiance.array();
}

TEST(LampBesideThreadTest, DirectLightIsThatOfAQuadrature) {
  for (const ThreadExit rule : {ThreadExit::far_side, ThreadExit::wandering})
    for (const double lamp_angle : {2.6, -1.9, 0.7}) {
      ThreadParameters thread{.sigma_a = {0.1, 0.4, 1}, .exit = rule};
      const SphereLight lamp{.center = Vector3d(0.05, std::sin(lamp_angle), std::cos(lamp_angle)) * 3 * kRadius_mm,
                             .radius_mm = 0.35 * kRadius_mm,
                             .radiance = {1, 1, 1},
                             .visible = false};
      Scene scene;
      CurveSet curve{.scattering = thread};
      for (int i = -3; i < 4; ++i)
        curve.control_points.push_back({static_cast<float>(4 * i), 0, 0, static_cast<float>(kRadius_mm)});
      for (std::uint32_t i = 0; i < 4; ++i) curve.segments.push_back(i);
      scene.curves.push_back(curve);
      scene.lights.push_back(lamp);
      // One pixel row across the thread, from straight above and far away.
      const Vector3d eye(60, 0, 200);
      Camera camera = camera_on(eye, {0, 0, 0}, {0, 1, 0}, 2.2 * kRadius_mm, 8, 8);
      const cv::Mat3f drawn = PathTracer(scene).render(camera, {.samples_per_pixel = 16384, .max_vertices = 1});
      Array3d expected = Array3d::Zero();
      int count = 0;
      constexpr int kRows = 48, kColumns = 1;
      for (int row = 0; row < kRows; ++row)
        for (int column = 0; column < kColumns; ++column, ++count) {
          const CameraRay ray = ray_through(camera, (column + 0.5) * camera.width / kColumns - 0.5,
                                            (row + 0.5) * camera.height / kRows - 0.5);
          const double a = ray.direction.tail<2>().squaredNorm(), b = ray.origin.tail<2>().dot(ray.direction.tail<2>()),
                       c = ray.origin.tail<2>().squaredNorm() - kRadius_mm * kRadius_mm, root = b * b - a * c;
          if (root < 0) continue;
          const Vector3d hit = ray.origin + (-b - std::sqrt(root)) / a * ray.direction;
          SphereLight seen = lamp;
          seen.center.x() -= hit.x();
          expected += light_of(thread, Vector3d(0, hit.y(), hit.z()) / kRadius_mm, -ray.direction, seen);
        }
      expected /= count;
      const cv::Scalar mean = cv::mean(drawn);
      std::printf("lamp at %4.1f, %s: drawn / quadrature %.4f %.4f %.4f\n", lamp_angle,
                  rule == ThreadExit::far_side ? "far side" : "wandering", mean[0] / expected[0], mean[1] / expected[1],
                  mean[2] / expected[2]);
      for (int c = 0; c < 3; ++c) EXPECT_NEAR(mean[c] / expected[c], 1, 0.01) << lamp_angle;
    }
}

}  // namespace
}  // namespace renderer

// Light sampling beside a lamp that is as near as threads are to each other, against a quadrature: places over the
// whole section, directions over the lamp as each of them sees it, no random numbers and no ray tracer.
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

// The integral of f_cos times `density` over the directions in which the lamp is seen from a place: rings of equal
// solid angle, so that the integrand is smooth.
template <class Density>
Array3d over_lamp(const Vector3d& place, const SphereLight& lamp, const CurveLobes<double>& lobes,
                  const Eigen::Matrix3d& frame, const Density& density) {
  constexpr int kRings = 4, kPerRing = 8;
  const Vector3d to = lamp.center - place, axis = to.normalized(), side = axis.unitOrthogonal(), up = axis.cross(side);
  const double cap = 1 - std::sqrt(1 - lamp.radius_mm * lamp.radius_mm / to.squaredNorm());
  Array3d sum = Array3d::Zero();
  for (int i = 0; i < kRings; ++i)
    for (int j = 0; j < kPerRing; ++j) {
      const double off = cap * (i + 0.5) / kRings, sine = std::sqrt(off * (2 - off)),
                   phi = 2 * std::numbers::pi * (j + 0.5 * (i % 2)) / kPerRing;
      const Vector3d wi = (1 - off) * axis + sine * (std::cos(phi) * side + std::sin(phi) * up);
      const double weight = density(wi);
      if (weight > 0) sum += lobes.evaluate(frame * wi).f_cos * weight;
    }
  return sum * (2 * std::numbers::pi * cap / (kRings * kPerRing));
}

// What a ray from unit direction wo that meets the thread at `entry` sees of the lamp by one scattering.
Array3d light_of(const ThreadParameters& thread, const Vector3d& entry, const Vector3d& wo, const SphereLight& lamp) {
  const ThreadModel<double> model(thread);
  const Eigen::Matrix3d frame = (Eigen::Matrix3d() << Vector3d::UnitX().transpose(),
                                 entry.cross(Vector3d::UnitX()).transpose(), entry.transpose())
                                    .finished();
  const Vector3d wo_local = frame * wo;
  const auto lobes = model.lobes_at(-wo_local.y() / std::hypot(wo_local.y(), wo_local.z()), wo_local);
  const bool far_side = thread.exit == ThreadExit::far_side;
  const double slope = far_side ? 0 : std::clamp(-wo.x() / std::hypot(wo.y(), wo.z()), -0.5, 0.5);
  Array3d sum = Array3d::Zero();
  if (far_side)
    sum += over_lamp(kRadius_mm * entry, lamp, lobes, frame,
                     [&](const Vector3d& wi) { return entry.dot(wi) >= 0 ? 1.0 : 0.0; });
  constexpr int kPlaces = 240;
  for (int k = 0; k < kPlaces; ++k) {
    const double angle = 2 * std::numbers::pi * (k + 0.5) / kPlaces;
    Vector3d place = kRadius_mm * Vector3d(0, std::cos(angle), std::sin(angle));
    place.x() = slope * (place - kRadius_mm * entry).tail<2>().norm();
    sum += over_lamp(place, lamp, lobes, frame,
                     [&](const Vector3d& wi) {
                       if (far_side && entry.dot(wi) >= 0) return 0.0;
                       return exit_density(thread.exit, entry, wo, wi, angle);
                     }) *
           (2 * std::numbers::pi / kPlaces);
  }
  return sum * lamp.radiance.array();
}

// A straight thread along x beside the lamp.
Scene thread_beside(const ThreadParameters& thread, const SphereLight& lamp) {
  CurveSet curve{.scattering = thread};
  for (int i = -3; i < 4; ++i)
    curve.control_points.push_back({static_cast<float>(4 * i), 0, 0, static_cast<float>(kRadius_mm)});
  for (std::uint32_t i = 0; i < 4; ++i) curve.segments.push_back(i);
  Scene scene;
  scene.curves.push_back(curve);
  scene.lights.push_back(lamp);
  return scene;
}

// The mean over a picture of the thread, from rays in even rows and columns.
Array3d mean_light(const ThreadParameters& thread, const SphereLight& lamp, const Camera& camera) {
  constexpr int kRows = 64, kColumns = 8;
  Array3d sum = Array3d::Zero();
  for (int i = 0; i < kRows * kColumns; ++i) {
    const double column = (i % kColumns + 0.5) / kColumns, row = (i / kColumns + 0.5) / kRows;
    const CameraRay ray = ray_through(camera, column * camera.width - 0.5, row * camera.height - 0.5);
    const Eigen::Vector2d o = ray.origin.tail<2>(), d = ray.direction.tail<2>();
    const double root = o.dot(d) * o.dot(d) - d.squaredNorm() * (o.squaredNorm() - kRadius_mm * kRadius_mm);
    if (root < 0) continue;
    const Vector3d hit = ray.origin + (-o.dot(d) - std::sqrt(root)) / d.squaredNorm() * ray.direction;
    SphereLight seen = lamp;
    seen.center.x() -= hit.x();
    sum += light_of(thread, Vector3d(0, hit.y(), hit.z()) / kRadius_mm, -ray.direction, seen);
  }
  return sum / (kRows * kColumns);
}

TEST(LampBesideThreadTest, DirectLightIsThatOfAQuadrature) {
  const Camera camera = camera_on({60, 0, 200}, {0, 0, 0}, {0, 1, 0}, 1.8 * kRadius_mm, 8, 8);  // within the silhouette
  for (const ThreadExit rule : {ThreadExit::far_side, ThreadExit::wandering})
    for (const double lamp_angle : {2.6, -1.9, 0.7}) {
      const ThreadParameters thread{.sigma_a = {0.1, 0.4, 1}, .exit = rule};
      const SphereLight lamp{.center = Vector3d(0.05, std::sin(lamp_angle), std::cos(lamp_angle)) * 3 * kRadius_mm,
                             .radius_mm = 0.35 * kRadius_mm,
                             .radiance = {1, 1, 1},
                             .visible = false};
      const cv::Scalar drawn = cv::mean(
          PathTracer(thread_beside(thread, lamp)).render(camera, {.samples_per_pixel = 16384, .max_vertices = 1}));
      const Array3d expected = mean_light(thread, lamp, camera);
      std::printf("lamp at %4.1f, %s: drawn / quadrature %.4f %.4f %.4f\n", lamp_angle,
                  rule == ThreadExit::far_side ? "far side" : "wandering", drawn[0] / expected[0],
                  drawn[1] / expected[1], drawn[2] / expected[2]);
      for (int c = 0; c < 3; ++c) EXPECT_NEAR(drawn[c] / expected[c], 1, 0.005) << lamp_angle;
    }
}

}  // namespace
}  // namespace renderer

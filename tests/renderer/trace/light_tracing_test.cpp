// The path tracer against particles from the light, which share nothing with it but the scattering model and the rays'
// meeting of curves, and against a quadrature without ray tracing: means of the scenes of fixtures/reference/README.md.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <limits>
#include <numbers>
#include <sstream>
#include <string>
#include <vector>

#include "renderer/trace/path_tracer.h"
#include "tests/places.h"
#include "tests/renderer/trace/curve_scenes.h"
#include "tests/renderer/trace/light_tracer.h"
#include "tests/support/asked.h"

namespace renderer {
namespace {

constexpr double kAgreement = 0.005;

// What the path tracer finds is within half a percent of the particles' means, and their standard errors are at most
// `error` of them.
void expect_the_means_of(const TracedLight& light, const CurveScene& scene, const std::vector<int>& counts,
                         double error, int samples = 4) {
  const PathTracer tracer(scene.scene);
  for (const int vertices : counts) {
    const cv::Scalar mean =
        cv::mean(tracer.render(scene.camera, {.samples_per_pixel = samples, .max_vertices = vertices}));
    const auto k = static_cast<std::size_t>(vertices - 1);
    std::printf("%2d vertices: path tracer %.4f %.4f %.4f, light tracer %.4f %.4f %.4f +- %.4f %.4f %.4f\n", vertices,
                mean[0], mean[1], mean[2], light.mean[k][0], light.mean[k][1], light.mean[k][2],
                light.standard_error[k][0], light.standard_error[k][1], light.standard_error[k][2]);
    for (int c = 0; c < 3; ++c) {
      const double relative_error = light.standard_error[k][c] / light.mean[k][c];
      // Or two standard errors, where the particles do not know their own mean to half as much.
      EXPECT_NEAR(mean[c] / light.mean[k][c], 1, std::max(kAgreement, 2 * relative_error))
          << vertices << " vertices, channel " << c;
      EXPECT_LT(relative_error, error) << vertices << " vertices, channel " << c;
    }
  }
}

void expect_the_same_means(const CurveScene& scene, const Eigen::Vector2d& aim_mm, std::int64_t particles,
                           const std::vector<int>& counts, double error = 0.003) {
  expect_the_means_of(trace_light(scene.scene, scene.camera, aim_mm, counts.back(), particles, 1), scene, counts,
                      error);
}

// Scene a by geometry of its own: 50 cylinders along x, in double, with exact surfaces.
class Cylinders {
 public:
  static constexpr int kCount = 50;
  static constexpr double kRadius_mm = 0.15, kPitch_mm = 0.3;

  static double middle(int i) { return (i - (kCount - 1) / 2.0) * kPitch_mm; }

  // Distance along the ray at which it enters cylinder i from outside; infinite: nowhere.
  static double entry(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction, int i) {
    const double y = origin.y() - middle(i), z = origin.z();
    const double a = direction.tail<2>().squaredNorm(), b = y * direction.y() + z * direction.z(),
                 c = y * y + z * z - kRadius_mm * kRadius_mm, square = b * b - a * c;
    const double distance = square > 0 ? (-b - std::sqrt(square)) / a : -1;
    return distance > 0 ? distance : std::numeric_limits<double>::infinity();
  }

  static bool blocked(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction, int own) {
    for (int i = 0; i < kCount; ++i)
      if (i != own && std::isfinite(entry(origin, direction, i))) return true;
    return false;
  }
};

// Mean direct light over the picture: pixels and light sampled evenly by a rank-1 sequence.
Eigen::Array3d direct_light_of_cylinders(const CurveScene& scene, int points) {
  const FiberModel<double> model(std::get<FiberParameters>(scene.scene.curves.front().scattering));
  const SphereLight& light = scene.scene.lights.front();
  constexpr double kRoot = 1.1673039782614187;  // of x^5 = x + 1: powers of its inverse fill four dimensions evenly
  Eigen::Array3d sum = Eigen::Array3d::Zero();
  for (int k = 1; k <= points; ++k) {
    std::array<double, 4> u{};
    for (std::size_t d = 0; d < 4; ++d) {
      const double turned = 0.5 + k / std::pow(kRoot, d + 1);
      u[d] = turned - std::floor(turned);
    }
    const CameraRay ray = ray_through(scene.camera, u[0] * scene.camera.width - 0.5, u[1] * scene.camera.height - 0.5);
    int nearest = 0;
    double distance = std::numeric_limits<double>::infinity();
    for (int i = 0; i < Cylinders::kCount; ++i) {
      const double entry = Cylinders::entry(ray.origin, ray.direction, i);
      if (entry < distance) distance = entry, nearest = i;
    }
    if (!std::isfinite(distance)) continue;
    const Eigen::Vector3d point = ray.origin + distance * ray.direction;
    const Eigen::Vector3d normal = Eigen::Vector3d(0, point.y() - Cylinders::middle(nearest), point.z()).normalized();
    const Eigen::Vector3d to_light = light.center - point, axis = to_light.normalized();
    const double sin2 = light.radius_mm * light.radius_mm / to_light.squaredNorm();
    const double cap = sin2 / (1 + std::sqrt(1 - sin2)), off = u[2] * cap, phi = 2 * std::numbers::pi * u[3];
    const Eigen::Vector3d side = axis.unitOrthogonal();
    const Eigen::Vector3d wi =
        axis * (1 - off) + std::sqrt(off * (2 - off)) * (std::cos(phi) * side + std::sin(phi) * axis.cross(side));
    if (Cylinders::blocked(point, wi, nearest)) continue;
    const Eigen::Vector3d along = Eigen::Vector3d::UnitX(), across = normal.cross(along);
    const auto local = [&](const Eigen::Vector3d& v) {
      return Eigen::Vector3d(v.dot(along), v.dot(across), v.dot(normal));
    };
    const Eigen::Vector3d wo = local(-ray.direction);
    const double h = -wo.y() / std::hypot(wo.y(), wo.z());
    sum += model.lobes_at(h, wo).evaluate(local(wi)).f_cos * light.radiance.array() * (2 * std::numbers::pi * cap);
  }
  return sum / points;
}

TEST(LightTracingTest, ParallelThreadsHaveTheDirectLightOfAQuadratureOverCylinders) {
  const CurveScene scene = parallel_threads_scene();
  const Eigen::Array3d expected = direct_light_of_cylinders(scene, 4'000'000);
  const cv::Scalar mean =
      cv::mean(PathTracer(scene.scene).render(scene.camera, {.samples_per_pixel = 16, .max_vertices = 1}));
  std::printf("path tracer %.5f %.5f %.5f, quadrature %.5f %.5f %.5f\n", mean[0], mean[1], mean[2], expected[0],
              expected[1], expected[2]);
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(mean[c] / expected[c], 1, 0.001) << c;
}

TEST(LightTracingTest, ParallelThreadsHaveTheMeanRadianceOfParticlesFromTheLight) {
  expect_the_same_means(parallel_threads_scene(), {12, 8}, 6'000'000, {1, 3, 8, 32});
}

// Threads that touch each other, so that where light leaves one decides what the next one catches.
TEST(LightTracingTest, ParallelThreadsInWhichLightWandersHaveTheMeanRadianceOfParticlesFromTheLight) {
  CurveScene scene = parallel_threads_scene();
  scene.scene.curves.front().scattering = ThreadParameters{.sigma_a = {0.05, 0.3, 0.8}, .exit = ThreadExit::wandering};
  expect_the_same_means(scene, {12, 8}, 6'000'000, {1, 3, 8});
}

// Few paths of many vertices carry much of the light of scene b, so that it takes 32 million particles, twenty minutes
// of two cores. Those of seeds 1 and 3 are kept, and a few are traced anew against them.
constexpr int kMostVertices = 8;

TracedLight kept_particles() {
  std::ifstream file(FIXTURES_DIR "/reference/plain_weave_particles.csv");
  std::string line;
  std::getline(file, line);
  TracedLight light;
  while (std::getline(file, line)) {
    std::replace(line.begin(), line.end(), ',', ' ');
    std::istringstream cells(line);
    int vertices = 0;
    Eigen::Array3d mean, error;
    cells >> vertices >> mean[0] >> mean[1] >> mean[2] >> error[0] >> error[1] >> error[2];
    EXPECT_TRUE(cells) << line;
    light.mean.push_back(mean), light.standard_error.push_back(error);
    EXPECT_EQ(vertices, std::ssize(light.mean)) << "a line for each number of vertices";
  }
  return light;
}

TEST(LightTracingTest, PlainWeaveHasTheMeanDirectLightOfParticlesFromTheLight) {
  const TracedLight kept = kept_particles();
  ASSERT_EQ(kept.mean.size(), kMostVertices);
  expect_the_means_of(kept, plain_weave_scene(), {1}, 0.001);
}

TEST(LightTracingTest, PlainWeaveHasTheMeanRadianceOfParticlesFromTheLight) {
  const TracedLight kept = kept_particles();
  ASSERT_EQ(kept.mean.size(), kMostVertices);
  // So many samples that the particles' noise is nearly all there is.
  expect_the_means_of(kept, plain_weave_scene(), {2, 3}, 0.004, 32);
  expect_the_means_of(kept, plain_weave_scene(), {kMostVertices}, 0.004, 64);
}

// THREADSTATION_PARTICLES in the environment says how many are traced, THREADSTATION_SEED from which seed. Their means
// and standard errors are printed as lines of the file of those that are kept.
TEST(LightTracingTest, ParticlesInPlainWeaveAreThoseThatAreKept) {
  constexpr double kDeviations = 4;
  const int particles = asked("THREADSTATION_PARTICLES", 1'000'000), seed = asked("THREADSTATION_SEED", 2);
  const CurveScene scene = plain_weave_scene();
  const TracedLight kept = kept_particles(), traced = trace_light(scene.scene, scene.camera, {46.5, 36}, kMostVertices,
                                                                  particles, static_cast<std::uint64_t>(seed));
  ASSERT_EQ(kept.mean.size(), kMostVertices);
  std::printf("seed %d, %d particles\n", seed, particles);
  for (std::size_t k = 0; k < kMostVertices; ++k) {
    const Eigen::Array3d &mean = traced.mean[k], &error = traced.standard_error[k];
    const Eigen::Array3d deviations = (mean - kept.mean[k]) / (error.square() + kept.standard_error[k].square()).sqrt();
    std::printf("%zu,%g,%g,%g,%g,%g,%g\n", k + 1, mean[0], mean[1], mean[2], error[0], error[1], error[2]);
    EXPECT_LT(deviations.abs().maxCoeff(), kDeviations) << k + 1 << " vertices: " << deviations.transpose();
  }
}

}  // namespace
}  // namespace renderer

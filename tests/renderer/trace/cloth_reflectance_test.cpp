#include "renderer/trace/cloth_reflectance.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "renderer/scattering/degree.h"
#include "renderer/trace/path_tracer.h"
#include "tests/renderer/trace/cloth_scenes.h"

namespace renderer {
namespace {

using Eigen::Array3d;
using Eigen::Vector3d;

Vector3d by_cosine(const Eigen::Vector2f& u) {
  const double radius = std::sqrt(static_cast<double>(u.x())), phi = 2 * std::numbers::pi * static_cast<double>(u.y());
  return {radius * std::cos(phi), radius * std::sin(phi), std::sqrt(1 - radius * radius)};
}

// What the cloth shows under a bright upper half of the world, by the path tracer.
cv::Scalar under_the_sky(const YarnPatch& patch, const Vector3d& wo) {
  Scene scene = two_scale_scene(SwatchShape{200, 200}, patch, red_and_blue_threads());
  cv::Mat3f sky(512, 1024, cv::Vec3f(0, 0, 0));
  sky.rowRange(0, 256).setTo(cv::Scalar(1, 1, 1));
  scene.surroundings = EnvironmentLight{.radiance = sky};
  // From far enough that rays are parallel; the frame is wide enough that parts of periods at its border count little.
  const Camera camera = camera_on(5000 * wo, {0, 0, 0}, {0, 1, 0}, 60, 128, 128);
  return cv::mean(PathTracer(scene).render(camera, {.samples_per_pixel = 16}));
}

TEST(ClothReflectanceTest, IntegratesToThePictureUnderASky) {
  const YarnPatch patch = plain_patch();
  const ClothReflectance cloth(patch, red_and_blue_threads());
  for (const Vector3d& wo : {Vector3d(0, 0, 1), Vector3d(0.6, 0.3, 0.5).normalized()}) {
    constexpr int kSamples = 200000;
    Sampler sampler(3, 5);
    Array3d sum = Array3d::Zero();
    for (int s = 0; s < kSamples; ++s) {
      sampler.start_sample(static_cast<std::uint32_t>(s));
      const Vector3d wi = by_cosine(sampler.next_2d());
      if (wi.z() > 1e-3) sum += std::numbers::pi * cloth.sample(wi, wo, sampler);
    }
    const cv::Scalar picture = under_the_sky(patch, wo);
    // Both to about 0.5 %.
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(sum[c] / kSamples, picture[c], 0.02 * picture[c]) << c;
  }
}

TEST(ClothReflectanceTest, ClothOfAlikeYarnsTurnsLessThanClothOfFloats) {
  const std::vector<ScatteringModel> threads{lossless_thread(), lossless_thread()};
  const double plain = anisotropy(ClothReflectance(plain_patch(), threads), 1),
               satin = anisotropy(ClothReflectance(satin_patch(), threads), 1);
  EXPECT_GT(satin, 1.5 * plain);
  EXPECT_GT(plain, 0);
}

TEST(ClothReflectanceTest, DirectionsOfCellsAreThoseOfTheirAngles) {
  for (const auto& [h, d, p] : {std::array{0, 0, 0}, {30, 20, 90}, {60, 10, 179}, {10, 80, 45}}) {
    const MerlDirections at = merl_directions(h, d, p);
    const Vector3d half = (at.wi + at.wo).normalized();
    EXPECT_NEAR(std::acos(half.z()), (h + 0.5) * (h + 0.5) / 8100 * std::numbers::pi / 2, 1e-6);
    EXPECT_NEAR(std::acos(half.dot(at.wi)), (d + 0.5) * kDegree, 1e-6);
    EXPECT_NEAR(at.wo.norm(), 1, 1e-12);
    const Vector3d flat = Eigen::AngleAxisd(-std::acos(half.z()), Vector3d::UnitY()) * at.wi;
    EXPECT_NEAR(std::atan2(flat.y(), flat.x()), (p + 0.5) * kDegree, 1e-5);
  }
}

}  // namespace
}  // namespace renderer

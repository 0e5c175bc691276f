#include "renderer/scene/environment_map.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <random>

#include "renderer/scattering/lobes.h"
#include "renderer/trace/lights.h"
#include "renderer/trace/path_tracer.h"

namespace renderer {
namespace {

using Eigen::Vector3d;

// A dim sky that brightens upwards, with a sun of a few pixels.
cv::Mat3f sky() {
  cv::Mat3f picture(32, 64);
  for (int row = 0; row < picture.rows; ++row) picture.row(row).setTo(cv::Scalar(0.2, 0.3, 0.5) * (1.5 - row / 32.0));
  picture({40, 9, 2, 2}).setTo(cv::Scalar(90, 80, 60));
  return picture;
}

TEST(EnvironmentMapTest, TheDensityIntegratesToOne) {
  const EnvironmentMap map({.radiance = sky(), .turn_rad = 0.4});
  double integral = 0;
  constexpr int kRows = 32 * 8, kColumns = 64 * 8;
  for (int row = 0; row < kRows; ++row)
    for (int column = 0; column < kColumns; ++column) {
      const double cosine = 1 - 2 * (row + 0.5) / kRows, sine = std::sqrt(1 - cosine * cosine);
      const double azimuth = 2 * std::numbers::pi * (column + 0.5) / kColumns;
      integral += map.pdf({sine * std::cos(azimuth), sine * std::sin(azimuth), cosine}) * 4 * std::numbers::pi / kRows /
                  kColumns;
    }
  EXPECT_NEAR(integral, 1, 0.01);  // rows of equal cosine cut pixels
}

TEST(EnvironmentMapTest, SampledDirectionsGiveTheWholeLightWithLittleNoise) {
  const EnvironmentMap map({.radiance = sky(), .turn_rad = -1.1});
  std::mt19937 random(3);
  std::uniform_real_distribution<float> u;
  constexpr int kDraws = 200000;
  double sum = 0, squares = 0, sphere = 0;
  for (int i = 0; i < kDraws; ++i) {
    const Vector3d direction = map.sample({u(random), u(random)});
    ASSERT_NEAR(direction.norm(), 1, 1e-9);
    const double density = map.pdf(direction);
    ASSERT_GT(density, 0);
    const double light = static_cast<double>(map.radiance(direction).sum()) / density;
    sum += light / kDraws, squares += light * light / kDraws, sphere += 1 / density / kDraws;
  }
  EXPECT_NEAR(sum / map.power(), 1, 0.01);  // bilinear light against that of whole pixels
  EXPECT_NEAR(sphere / (4 * std::numbers::pi), 1, 0.02);
  // The sun is four pixels of 2048 and half of the light: uniform directions would scatter by ten times their mean.
  EXPECT_LT(std::sqrt(squares / (sum * sum) - 1), 1);
}

TEST(EnvironmentMapTest, APixelLiesWhereItsRowAndColumnSay) {
  cv::Mat3f one(30, 60, cv::Vec3f(0, 0, 0));
  one(7, 15) = {0, 4, 0};  // a quarter of the way down; a quarter round and a half pixel: beyond +y
  const double angle = 2 * std::numbers::pi * 15.5 / 60, polar = std::numbers::pi * 7.5 / 30;
  const Vector3d there(std::sin(polar) * std::cos(angle), std::sin(polar) * std::sin(angle), std::cos(polar));
  EXPECT_NEAR(EnvironmentMap({.radiance = one}).radiance(there)[1], 4, 1e-5);
  EXPECT_NEAR(EnvironmentMap({.radiance = one}).radiance(-there)[1], 0, 1e-9);
  const Vector3d turned = Eigen::AngleAxisd(0.7, Vector3d::UnitZ()) * there;
  EXPECT_NEAR(EnvironmentMap({.radiance = one, .turn_rad = 0.7}).radiance(turned)[1], 4, 1e-5);
}

TEST(EnvironmentMapTest, NegativeLightIsRefused) {
  for (const float bad : {-1.0F, std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()}) {
    cv::Mat3f picture = sky();
    picture(3, 4)[1] = bad;
    EXPECT_THROW(EnvironmentMap({.radiance = picture}), std::runtime_error);
  }
  EXPECT_THROW(EnvironmentMap({}), std::runtime_error);
}

// A matt floor of albedo 0.5 that looks up, seen from above; mean radiance of the picture.
cv::Scalar floor_under(Scene scene, int samples) {
  scene.meshes = {TriangleMesh{.vertices = {{-9, -9, 0}, {9, -9, 0}, {9, 9, 0}, {-9, 9, 0}},
                               .triangles = {{0, 1, 2}, {0, 2, 3}},
                               .albedo = cv::Mat3f(1, 1, cv::Vec3f(0.5F, 0.5F, 0.5F))}};
  Camera camera = look_at({0, 0, 50}, {0, 0, 0}, {0, 1, 0});
  camera.width = camera.height = 16;
  camera.fx = camera.fy = 100;
  camera.cx = camera.cy = 7.5;
  return cv::mean(PathTracer(std::move(scene)).render(camera, {.samples_per_pixel = samples}));
}

TEST(LightsTest, EvenSurroundingsLightAsASurroundingSphereDoes) {
  Scene scene;
  scene.surroundings = EnvironmentLight{.radiance = cv::Mat3f(8, 16, cv::Vec3f(1, 2, 4)), .visible = false};
  const cv::Scalar mean = floor_under(scene, 256);
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(mean[c] / (0.5 * (1 << c)), 1, 0.01);
}

// The sun of the sky, and a sphere beside it: light adds up, and either can be drawn.
TEST(LightsTest, SurroundingsAndSpheresAddUp) {
  const SphereLight lamp{.center = {30, 0, 60}, .radius_mm = 4, .radiance = {50, 50, 50}};
  Scene both, sky_alone, lamp_alone;
  both.surroundings = sky_alone.surroundings = EnvironmentLight{.radiance = sky(), .turn_rad = 0.3};
  both.lights = lamp_alone.lights = {lamp};
  const cv::Scalar sum = floor_under(sky_alone, 256) + floor_under(lamp_alone, 256), together = floor_under(both, 256);
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(together[c] / sum[c], 1, 0.01);
  // By summing the sky itself: E = sum of L cos dOmega over the upper half.
  const cv::Mat3f picture = sky();
  const cv::Scalar seen = floor_under(sky_alone, 256);
  for (int c = 0; c < 3; ++c) {
    double irradiance = 0;
    for (int row = 0; row < 16; ++row)
      for (int column = 0; column < 64; ++column) {
        const double top = std::cos(std::numbers::pi * row / 32), bottom = std::cos(std::numbers::pi * (row + 1) / 32);
        irradiance += static_cast<double>(picture(row, column)[c]) * 2 * std::numbers::pi / 64 *
                      (top * top - bottom * bottom) / 2;
      }
    EXPECT_NEAR(seen[c] / (0.5 / std::numbers::pi * irradiance), 1, 0.02);  // bilinear at the horizon
  }
}

TEST(LightsTest, SurroundingsAreSeenByTheCameraUnlessHidden) {
  Scene scene;
  scene.surroundings = EnvironmentLight{.radiance = cv::Mat3f(8, 16, cv::Vec3f(1, 2, 4))};
  EXPECT_TRUE(Lights(scene).intersect(Vector3d::Zero(), Vector3d::UnitX(), true));
  scene.surroundings->visible = false;
  EXPECT_FALSE(Lights(scene).intersect(Vector3d::Zero(), Vector3d::UnitX(), true));
  EXPECT_TRUE(Lights(scene).intersect(Vector3d::Zero(), Vector3d::UnitX(), false));
}

}  // namespace
}  // namespace renderer

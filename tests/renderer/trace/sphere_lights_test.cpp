#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "renderer/trace/lights.h"

namespace renderer {
namespace {

using Eigen::Vector3d;

const std::vector<SphereLight> kTwoLights{{.center = {0, 0, 100}, .radius_mm = 20},
                                          {.center = {80, 0, 90}, .radius_mm = 35, .radiance = {3, 2, 1}}};

// Solid angle in which light is seen, from the reciprocal density of sampled directions.
TEST(SphereLightsTest, DensityIsThatOfTheSampledDirections) {
  const Lights lights({.lights = kTwoLights});
  double mean = 0;
  constexpr int kSide = 40;
  for (int i = 0; i < kSide * kSide * kSide; ++i) {
    const Eigen::Vector3f u =
        (Eigen::Vector3i(i % kSide, i / kSide % kSide, i / kSide / kSide).cast<float>().array() + 0.5f) / kSide;
    const auto direction = lights.sample({1, 2, 3}, u.z(), u.head<2>());
    ASSERT_TRUE(direction);
    EXPECT_NEAR(direction->norm(), 1, 1e-9);
    EXPECT_TRUE(lights.intersect({1, 2, 3}, *direction, false));
    mean += 1 / lights.pdf({1, 2, 3}, *direction) / (kSide * kSide * kSide);
  }
  const auto solid_angle = [](const SphereLight& light) {
    const double sine = light.radius_mm / (light.center - Vector3d(1, 2, 3)).norm();
    return 2 * std::numbers::pi * (1 - std::sqrt(1 - sine * sine));
  };
  // The two cones do not overlap, so the mean of 1 / density is the sum of their solid angles; the last light of a
  // stratum of u_light adds an error of one part in forty at most.
  EXPECT_NEAR(mean, solid_angle(kTwoLights[0]) + solid_angle(kTwoLights[1]), 0.05 * mean);
}

TEST(SphereLightsTest, TheNearestLightIsSeen) {
  const Lights lights({.lights = {{.center = {0, 0, 100}, .radius_mm = 5, .radiance = {1, 1, 1}},
                                  {.center = {0, 0, 50}, .radius_mm = 5, .radiance = {2, 2, 2}, .visible = false}}});
  const auto seen = lights.intersect(Vector3d::Zero(), Vector3d::UnitZ(), false);
  EXPECT_NEAR(seen->distance, 45, 1e-9);
  EXPECT_EQ(seen->radiance[0], 2);
  EXPECT_EQ(lights.intersect(Vector3d::Zero(), Vector3d::UnitZ(), true)->radiance[0], 1);
  EXPECT_FALSE(lights.intersect(Vector3d::Zero(), -Vector3d::UnitZ(), false));
}

TEST(SphereLightsTest, ASurroundingSphereIsSeenAndSampledInAllDirections) {
  const Lights lights({.lights = {{.radius_mm = 1000}}});
  EXPECT_NEAR(lights.pdf({10, 0, 0}, Vector3d::UnitX()), 1 / (4 * std::numbers::pi), 1e-12);
  EXPECT_NEAR(lights.intersect({10, 0, 0}, Vector3d::UnitX(), true)->distance, 990, 1e-9);
  Vector3d mean = Vector3d::Zero();
  for (int i = 0; i < 64; ++i)
    mean +=
        *lights.sample({10, 0, 0}, 0, {(static_cast<float>(i % 8) + 0.5f) / 8, (static_cast<float>(i / 8) + 0.5f) / 8});
  EXPECT_LT(mean.norm(), 1e-5);  // a symmetric lattice of directions; single-precision input
}

TEST(SphereLightsTest, ABeamFallsOffWithThePowerOfTheCosineFromItsAxis) {
  SphereLight light{.center = {0, 0, 100}, .radius_mm = 5, .beam_axis = {0, 0, -1}, .beam_exponent = 3};
  const auto seen_from = [&light](const Vector3d& point) {
    return Lights({.lights = {light}}).intersect(point, (light.center - point).normalized(), false)->radiance[0];
  };
  EXPECT_FLOAT_EQ(seen_from({0, 0, 0}), 1.0f);
  EXPECT_FLOAT_EQ(seen_from({100, 0, 0}), static_cast<float>(std::pow(0.5, 1.5)));  // 45 degrees off its axis
  EXPECT_EQ(seen_from({0, 0, 200}), 0.0f);                                          // behind it
  light.beam_exponent = 0;
  EXPECT_EQ(seen_from({0, 0, 200}), 1.0f);
}

TEST(SphereLightsTest, WithoutLightsThereIsNothingToSample) {
  const Lights lights({});
  EXPECT_FALSE(lights.sample(Vector3d::Zero(), 0.5f, {0.5f, 0.5f}));
  EXPECT_EQ(lights.pdf(Vector3d::Zero(), Vector3d::UnitX()), 0);
}

}  // namespace
}  // namespace renderer

// glTF's formulas against laws and against numbers that are worked out by hand.
#include "station/cloth/export/gltf_brdf.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "station/cloth/export/cloth_far_field.h"

namespace station {
namespace {

using Eigen::Vector3d;

const GltfMaterial kVelvet{.roughness = 0.6, .specular = 1, .specular_level = 2, .sheen = 1, .sheen_roughness = 0.4};

// Mean of f over the upper hemisphere, uniformly in solid angle, times its 2 pi.
template <class F>
double over_hemisphere(const F& f) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> uniform(0, 1);
  constexpr int kDirections = 400000;
  double sum = 0;
  for (int i = 0; i < kDirections; ++i) {
    const double z = uniform(random), phi = 2 * std::numbers::pi * uniform(random), sine = std::sqrt(1 - z * z);
    sum += f(Vector3d(sine * std::cos(phi), sine * std::sin(phi), z));
  }
  return 2 * std::numbers::pi * sum / kDirections;
}

double all_of(const GltfShader& shader, const GltfShader::Lobes& lobes) {
  return shader.radiance(lobes, {}).maxCoeff() + lobes.reflected;
}

TEST(GltfBrdf, HighlightAndBaseFacingTheLightAreThoseOfTheFormulas) {
  const GltfShader shader(GltfMaterial{.roughness = 1, .specular_level = 1});
  const auto lobes = shader.lobes(Vector3d::UnitZ(), Vector3d::UnitZ(), Vector3d::UnitZ(), 1);
  // alpha = 1: D = 1 / pi, V = 1 / 4, F = 0.04, times pi.
  EXPECT_NEAR(lobes.facing, 0.01, 1e-12);
  EXPECT_NEAR(lobes.grazing, 0, 1e-12);
  EXPECT_NEAR(lobes.reflected, 0.96, 1e-12);
  EXPECT_EQ(lobes.sheen, 0);
}

TEST(GltfBrdf, CharlieDistributionCoversTheSurfaceOnce) {
  for (const double alpha : {0.04, 0.25, 1.0})
    EXPECT_NEAR(over_hemisphere([&](const Vector3d& h) { return charlie_distribution(h.z(), alpha) * h.z(); }), 1, 0.01)
        << alpha;
}

TEST(GltfBrdf, SheenAlbedoIsTheIntegralOfItsLobe) {
  const SheenAlbedo albedo(0.4);
  for (const double cosine : {0.25, 0.6, 0.95}) {
    const Vector3d view(std::sqrt(1 - cosine * cosine), 0, cosine);
    const double integral = over_hemisphere([&](const Vector3d& light) {
      return charlie_distribution((view + light).normalized().z(), 0.16) * charlie_visibility(cosine, light.z(), 0.16) *
             light.z();
    });
    EXPECT_NEAR(albedo.at(cosine), integral, 0.01 * integral + 0.002) << cosine;
    EXPECT_LT(integral, 1);
  }
}

double albedo_of(const GltfMaterial& material, const Vector3d& view) {
  const GltfShader shader(material);
  return over_hemisphere(
             [&](const Vector3d& light) { return all_of(shader, shader.lobes(Vector3d::UnitZ(), view, light, 1)); }) /
         std::numbers::pi;
}

TEST(GltfBrdf, WhiteSurfaceGivesBackAllLightAndUnderSheenNoMore) {
  for (const double polar_deg : {0.0, 40.0, 80.0}) {
    const Vector3d view = direction_at(polar_deg, 20);
    EXPECT_NEAR(albedo_of({.specular = 0}, view), 1, 0.005) << polar_deg;
    for (const double sheen : {0.5, 1.0}) {
      const double albedo = albedo_of({.specular = 0, .sheen = sheen, .sheen_roughness = 0.4}, view);
      EXPECT_LT(albedo, 1.005) << sheen << ", " << polar_deg;  // noise of the integral
      EXPECT_GT(albedo, 0.6);
    }
  }
}

// The specification's mixing of highlight and base does not conserve energy: seen at 80 degrees a white surface gives
// back up to 1.027 of the light. Seen straight on, the highlight gives back what it takes from the base.
TEST(GltfBrdf, HighlightTakesFromTheBaseWhatItGivesBack) {
  EXPECT_NEAR(albedo_of({.roughness = 0.4, .specular_level = 2}, Vector3d::UnitZ()), 1, 0.01);
  EXPECT_LT(albedo_of(kVelvet, direction_at(40, 0)), 1.005);
}

TEST(GltfBrdf, LightAndViewCanChangePlaces) {
  const GltfShader shader(kVelvet);
  for (const double strength : {1.0, 0.3})
    for (const auto& [a, b] : {std::pair(direction_at(30, 0), direction_at(65, 80)),
                               std::pair(direction_at(10, 200), direction_at(75, 30))}) {
      const auto there = shader.lobes(Vector3d::UnitZ(), a, b, strength),
                 back = shader.lobes(Vector3d::UnitZ(), b, a, strength);
      EXPECT_NEAR(all_of(shader, there) / b.z(), all_of(shader, back) / a.z(), 1e-9);
    }
}

TEST(GltfBrdf, LightFromBehindIsLetThroughEvenlyAndNeitherShinesNorReflects) {
  const GltfShader shader(GltfMaterial{.specular = 0});
  const auto lobes = shader.lobes(Vector3d::UnitZ(), direction_at(20, 0), direction_at(120, 40), 1);
  EXPECT_NEAR(lobes.transmitted, 0.5, 1e-12);
  EXPECT_EQ(lobes.reflected, 0);
  EXPECT_TRUE((shader.radiance(lobes, {}) == 0).all());
}

}  // namespace
}  // namespace station

// Where light leaves threads: on round and pressed sections, drawn direction first and place first.
#include "renderer/trace/light_exit.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <optional>

#include "renderer/scattering/exit_offsets.h"
#include "renderer/trace/path_vertex.h"

namespace renderer {
namespace {

using Eigen::Vector3f;

const Vector3f kAxis(3, 4, 5);

// A thread along z whose section is an ellipse of half axes `wide` along y and `high` along x, met at `angle` on it.
CurvePoint point_on(float wide, float high, float angle) {
  CurvePoint point{};
  point.tangent = {0, 0, 1};
  point.out = {high * std::cos(angle), wide * std::sin(angle), 0};
  point.side = {high * std::sin(angle), -wide * std::cos(angle), 0};
  point.position = kAxis + point.out;
  point.normal = Vector3f(std::cos(angle) / high, std::sin(angle) / wide, 0).normalized();
  return point;
}

// How far a place is from the section's rim: x^2 / high^2 + y^2 / wide^2 - 1.
float off_rim(const Vector3f& place, float wide, float high) {
  const Vector3f d = place - kAxis;
  return d.x() * d.x() / (high * high) + d.y() * d.y() / (wide * wide) - 1;
}

struct Section {
  float wide, high;
};
constexpr Section kSections[] = {{0.25f, 0.25f}, {0.4f, 0.16f}};

TEST(LightExitTest, AFiberAndAThreadWithoutWanderingSendLightOnFromWhereItCameIn) {
  const CurvePoint entry = point_on(0.25f, 0.25f, 0.3f);
  const ThreadExits exits(ThreadExit::entry_point, entry, Vector3f(1, 0, 0));
  Sampler sampler(1, 1);
  for (const Vector3f& wi : {Vector3f(1, 0, 0), Vector3f(-0.6f, 0.8f, 0)}) {
    EXPECT_EQ(exits.toward(wi, sampler).place, entry.position);
    EXPECT_EQ(exits.share(exits.near(wi, sampler), wi), 1);
    EXPECT_EQ(exits.ray(exits.toward(wi, sampler), wi).lead, 0);
  }
  const auto models = prepare_curve_models(std::vector<ScatteringModel>{ThreadParameters{.exit = ThreadExit::far_side},
                                                                        FiberParameters{}, YarnParameters{}});
  EXPECT_EQ(exit_of(models[0]), ThreadExit::far_side);
  for (std::size_t i : {1u, 2u}) EXPECT_EQ(exit_of(models[i]), ThreadExit::entry_point);
}

TEST(LightExitTest, OffsetsOfAPressedThreadAreSharesOfTheWidthThatIsSeen) {
  for (const auto& [wide, high] : kSections)
    for (const float angle : {-1.2f, -0.3f, 0.0f, 0.9f}) {
      const CurvePoint entry = point_on(wide, high, angle);
      EXPECT_NEAR(offset_in_section(entry, {1, 0, 0}), -std::sin(angle), 1e-6);  // y over the half width
      EXPECT_NEAR(offset_in_section(entry, Vector3f(0.8f, 0, 0.6f)), -std::sin(angle), 1e-6);
    }
}

TEST(LightExitTest, ByItsFarSideLightLeavesAnywhereAcrossTheWidthThatItsDirectionSees) {
  for (const auto& [wide, high] : kSections) {
    const CurvePoint entry = point_on(wide, high, 0);
    const ThreadExits exits(ThreadExit::far_side, entry, Vector3f(1, 0, 0));
    Sampler sampler(1, 2);
    EXPECT_EQ(exits.toward({0.6f, 0.8f, 0}, sampler).place, entry.position);
    double mean = 0, square = 0;
    constexpr int kDraws = 4096;
    for (int i = 0; i < kDraws; ++i) {
      sampler.start_sample(static_cast<std::uint32_t>(i));
      const Vector3f place = exits.toward({-1, 0, 0}, sampler).place;
      EXPECT_NEAR(off_rim(place, wide, high), 0, 1e-4);
      EXPECT_LE(place.x(), kAxis.x() + 1e-6f);
      EXPECT_EQ(place.z(), kAxis.z());
      const double offset = static_cast<double>((place.y() - kAxis.y()) / wide);
      mean += offset / kDraws, square += offset * offset / kDraws;
    }
    EXPECT_NEAR(mean, 0, 1e-3);
    EXPECT_NEAR(square, 1.0 / 3, 1e-3);
  }
}

// A ray that wanders straight on leaves, on average, nearly as far from the axis as it came in, on the same side.
TEST(LightExitTest, WanderingLightRemembersWhereItCameIn) {
  for (const auto& [wide, high] : kSections)
    for (const float angle : {-0.9f, 0.9f}) {
      const CurvePoint entry = point_on(wide, high, angle);
      const ThreadExits exits(ThreadExit::wandering, entry, Vector3f(1, 0, 0));
      Sampler sampler(1, 3);
      double mean = 0;
      constexpr int kDraws = 1024;
      for (int i = 0; i < kDraws; ++i) {
        sampler.start_sample(static_cast<std::uint32_t>(i));
        mean += static_cast<double>((exits.toward({-1, 0.01f, 0}, sampler).place.y() - kAxis.y()) / wide) / kDraws;
      }
      EXPECT_GT(mean / static_cast<double>(std::sin(angle)), 0.5);
      EXPECT_LT(mean / static_cast<double>(std::sin(angle)), 1);
    }
}

// Any function of the place has the same mean when places are drawn for another direction and weighted.
TEST(LightExitTest, PlacesDrawnForAnotherDirectionAndWeightedAreThoseOfThisOne) {
  for (const ThreadExit rule : {ThreadExit::entry_point, ThreadExit::far_side, ThreadExit::wandering})
    for (const auto& [wide, high] : kSections)
      for (const Vector3f& wi : {Vector3f(-0.8f, 0.6f, 0), Vector3f(0.7f, 0.1f, 0.7f).normalized(),
                                 Vector3f(-0.2f, -0.9f, 0.4f).normalized()}) {
        const CurvePoint entry = point_on(wide, high, 0.5f);
        const ThreadExits exits(rule, entry, Vector3f(0.9f, 0.3f, 0.3f).normalized());
        const Vector3f about = (wi + Vector3f(0.1f, -0.25f, 0.1f)).normalized();
        Eigen::Array4d drawn = Eigen::Array4d::Zero(), weighted = Eigen::Array4d::Zero();
        constexpr int kDraws = 1 << 16;
        Sampler sampler(1, 4);
        for (int i = 0; i < kDraws; ++i) {
          sampler.start_sample(static_cast<std::uint32_t>(i));
          const auto features = [](const LightExit& exit) {
            const Eigen::Array3d d = (exit.place - kAxis).cast<double>();
            return Eigen::Array4d(1, d.x(), d.y(), d.z() + d.x() * d.y());
          };
          drawn += features(exits.toward(wi, sampler)) / kDraws;
          const LightExit exit = exits.near(about, sampler);
          weighted += features(exit) * static_cast<double>(exits.share(exit, wi)) / kDraws;
        }
        for (int k = 0; k < 4; ++k)
          EXPECT_NEAR(weighted[k], drawn[k], 0.01 * (k == 0 ? 1 : static_cast<double>(wide))) << k;
      }
}

// Rays begin inside the thread and pass the place at which they leave it.
TEST(LightExitTest, RaysBeginInsideAndLeaveAtTheirPlace) {
  for (const auto& [wide, high] : kSections) {
    const CurvePoint entry = point_on(wide, high, 0.5f);
    const ThreadExits exits(ThreadExit::wandering, entry, Vector3f(0.9f, 0.3f, 0.3f).normalized());
    Sampler sampler(1, 5);
    float deepest = 0;
    for (int i = 0; i < 1000; ++i) {
      sampler.start_sample(static_cast<std::uint32_t>(i));
      const float phi = 2 * std::numbers::pi_v<float> * static_cast<float>(i) / 1000, z = 0.9f * std::sin(7 * phi);
      const Vector3f wi(std::sqrt(1 - z * z) * std::cos(phi), std::sqrt(1 - z * z) * std::sin(phi), z);
      const LightExit exit = exits.toward(wi, sampler);
      const LeavingRay leaving = exits.ray(exit, wi);
      EXPECT_LE(off_rim(leaving.ray.origin, wide, high), 1e-3f);
      deepest = std::min(deepest, off_rim(leaving.ray.origin, wide, high));
      EXPECT_EQ(exits.share(exit, wi), 1);
      EXPECT_LT((leaving.ray.origin + leaving.lead * wi - exit.place).norm(), 1e-5f);
      EXPECT_GE(off_rim(exit.place + 0.01f * wi, wide, high), 0);
    }
    EXPECT_LT(deepest, -0.95f);  // near the axis
  }
}

// A yarn that another one is pressed into: light that leaves the first inside the second meets the second.
TEST(LightExitTest, LightThatLeavesInsideAnotherYarnMeetsIt) {
  constexpr float kRadius = 0.25f;
  for (const ThreadExit rule : {ThreadExit::far_side, ThreadExit::wandering}) {
    Scene scene;
    for (const float depth : {0.0f, 0.4f}) {  // axes along x and, 0.4 mm below, along y: they overlap by 0.1 mm
      CurveSet yarn{.scattering = ThreadParameters{.exit = rule}};
      for (int i = -3; i < 5; ++i) {
        const auto along = static_cast<float>(i);
        yarn.control_points.push_back({depth > 0 ? 0 : along, depth > 0 ? along : 0, -depth, kRadius});
      }
      for (std::uint32_t i = 0; i < 5; ++i) yarn.segments.push_back(i);
      scene.curves.push_back(yarn);
    }
    const RayScene rays(std::move(scene));
    const auto models = prepare_curve_models(scattering_models(rays.scene()));
    const Vector3f down(0, 0, -1);
    const std::optional<SurfaceHit> hit = rays.intersect({{0, 0.05f, 1}, down});
    ASSERT_TRUE(hit && std::get<CurvePoint>(hit->point).curve_set == 0);
    const PathVertex vertex(*hit, -down, models);
    Sampler sampler(1, 6);
    int met = 0, inside = 0;
    for (int i = 0; i < 500; ++i) {
      sampler.start_sample(static_cast<std::uint32_t>(i));
      const LightExit exit = vertex.exit_toward(down, sampler);
      const float x = exit.place.x(), below = exit.place.z() + 0.4f;
      if (!(x * x + below * below < 0.95f * kRadius * kRadius)) continue;
      ++inside;
      const std::optional<SurfaceHit> next = rays.intersect(vertex.ray_from(exit, down).ray);
      met += next && std::get<CurvePoint>(next->point).curve_set == 1;
    }
    EXPECT_GT(inside, 100);
    EXPECT_EQ(met, inside);
  }
}

}  // namespace
}  // namespace renderer

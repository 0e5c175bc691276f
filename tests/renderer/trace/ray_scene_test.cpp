#include "renderer/trace/ray_scene.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <limits>
#include <random>

namespace renderer {
namespace {

using Eigen::Vector3f;

// One straight thread of radius 0.5 along x.
Scene one_thread() {
  CurveSet set;
  set.add_clamped_curve({{-30, 0, 0, 0.5f}, {0, 0, 0, 0.5f}, {30, 0, 0, 0.5f}});
  return {.curves = {set}};
}

TEST(RaySceneTest, CurvesAreHitWhereTheirCylinderIs) {
  const RayScene scene(one_thread());
  for (float x : {-29.9f, -3.0f, 0.0f, 29.9f}) {
    for (float y : {-0.49f, -0.2f, 0.0f, 0.45f}) {
      const auto hit = scene.intersect({{x, y, 10}, {0, 0, -1}});
      ASSERT_TRUE(hit) << x << ' ' << y;
      const float z = std::sqrt(0.25f - y * y);
      EXPECT_NEAR(hit->distance, 10 - z, 2e-4);
      const auto& point = std::get<CurvePoint>(hit->point);
      EXPECT_LT((point.normal - Vector3f(0, y, z) / 0.5f).norm(),
                2e-3);  // h is read from it; Embree's iteration ends there
      EXPECT_NEAR(std::abs(point.tangent.x()), 1, 1e-5);
      EXPECT_LT((point.position - Vector3f(x, y, z)).norm(), 1.5e-3);
    }
  }
  for (const Vector3f& origin : {Vector3f(0, 0.51f, 10), Vector3f(30.1f, 0, 10), Vector3f(-30.1f, 0, 10)})
    EXPECT_FALSE(scene.intersect({origin, {0, 0, -1}}));
}

// A sheet of touching threads as wrapped spools have it, whose segments Embree takes for cylinders.
class SheetTest : public testing::Test {
 protected:
  static constexpr int kThreads = 40, kSegments = 10;
  static constexpr float kRadius = 0.25f, kLength = 6.8f;

  static Scene sheet() {
    CurveSet set;
    for (int thread = 0; thread < kThreads; ++thread) {
      const auto first = static_cast<std::uint32_t>(set.control_points.size());
      for (int i = -1; i <= kSegments + 1; ++i)
        set.control_points.emplace_back(0.0f, kLength * (static_cast<float>(i) - 0.5f * kSegments), middle(thread),
                                        kRadius);
      for (std::uint32_t i = 0; i < kSegments; ++i) set.segments.push_back(first + i);
    }
    return {.curves = {set}};
  }
  static float middle(int thread) { return 2 * kRadius * (static_cast<float>(thread) - 0.5f * kThreads); }
  // The least distance at which the ray enters an endless cylinder.
  static double entry(const Ray& ray) {
    double nearest = std::numeric_limits<double>::infinity();
    const Eigen::Vector2d d(static_cast<double>(ray.direction.x()), static_cast<double>(ray.direction.z()));
    for (int thread = 0; thread < kThreads; ++thread) {
      const Eigen::Vector2d o(static_cast<double>(ray.origin.x()),
                              static_cast<double>(ray.origin.z()) - static_cast<double>(middle(thread)));
      const double a = d.squaredNorm(), b = o.dot(d), c = o.squaredNorm() - 0.0625, root2 = b * b - a * c;
      const double distance = (-b - std::sqrt(std::max(0.0, root2))) / a;
      if (root2 > 0 && distance > 0) nearest = std::min(nearest, distance);
    }
    return nearest;
  }
  Vector3f random_direction() { return Vector3f(normal_(random_), normal_(random_), normal_(random_)).normalized(); }

  RayScene scene_{sheet()};
  std::mt19937 random_{7};
  std::normal_distribution<float> normal_;
  std::uniform_real_distribution<float> uniform_{-1, 1};
};

TEST_F(SheetTest, RaysFromTheCameraAndFromHitsMeetTheCylinders) {
  constexpr int kRays = 200'000;
  int wrong = 0, met = 0, second = 0;
  const auto compare = [&](const Ray& ray) {
    const auto hit = scene_.intersect(ray);
    const double expected = entry(ray);
    const bool far = !(expected < 20);  // what lies there may be an end
    if (far) return hit;
    met += hit.has_value();
    wrong += !hit || std::abs(static_cast<double>(hit->distance) - expected) > 2e-3 || !scene_.occluded(ray, 100);
    return hit;
  };
  for (int i = 0; i < kRays; ++i) {
    const Vector3f from(4 + 3 * uniform_(random_), 10 * uniform_(random_), 6 * uniform_(random_)),
        to(0, 10 * uniform_(random_), 6 * uniform_(random_));
    const auto hit = compare({from, (to - from).normalized()});
    if (!hit) continue;
    const auto& point = std::get<CurvePoint>(hit->point);
    Vector3f onwards = random_direction();
    if (onwards.dot(point.normal) < 0) onwards = -onwards;
    second += compare({point.position, onwards}).has_value();
  }
  std::printf("%d of %d rays meet something else, %d of them from hits\n", wrong, met, second);
  EXPECT_GT(met, 240'000);
  EXPECT_LT(wrong, 1e-4 * met);
}

TEST(RaySceneTest, ARayInsideACurveLeavesItUnseen) {
  const RayScene scene(one_thread());
  for (const Vector3f& direction : {Vector3f(0, 0, 1), Vector3f(0, 0.6f, -0.8f), Vector3f(0.8f, 0.6f, 0)}) {
    EXPECT_FALSE(scene.intersect({{0, 0.1f, 0}, direction}));
    EXPECT_FALSE(scene.occluded({{0, 0.1f, 0}, direction}, 100));
  }
}

TEST(RaySceneTest, ARayThatStartsAtAHitMeetsNothingOfTheSameThread) {
  const RayScene scene(one_thread());
  for (int i = 0; i < 200; ++i) {
    const float y = 0.4999f * std::sin(static_cast<float>(i));
    const auto hit = scene.intersect({{0.1f * static_cast<float>(i), y, 10}, {0, 0, -1}});
    ASSERT_TRUE(hit);
    const float angle = 0.7f * static_cast<float>(i);
    EXPECT_FALSE(scene.intersect({std::get<CurvePoint>(hit->point).position, {0, std::cos(angle), std::sin(angle)}}));
  }
}

TEST(RaySceneTest, OcclusionEndsAtTheGivenDistance) {
  const RayScene scene(one_thread());
  EXPECT_TRUE(scene.occluded({{0, 0, 10}, {0, 0, -1}}, 9.6f));
  EXPECT_FALSE(scene.occluded({{0, 0, 10}, {0, 0, -1}}, 9.4f));
}

TEST(RaySceneTest, ClampedCurvesStartAndEndAtTheirEndPoints) {
  CurveSet set;
  set.add_clamped_curve({{0, 0, 0, 0.1f}, {10, 5, 0, 0.1f}, {20, -5, 0, 0.1f}, {30, 0, 0, 0.1f}});
  const RayScene scene({.curves = {set}});
  EXPECT_TRUE(scene.meets_curve_first({{0.02f, 0.01f, 10}, {0, 0, -1}}));
  EXPECT_TRUE(scene.meets_curve_first({{29.98f, 0.01f, 10}, {0, 0, -1}}));
  EXPECT_NEAR(scene.bounds().min().x(), 0, 0.15);
  EXPECT_NEAR(scene.bounds().max().x(), 30, 0.15);
}

TEST(RaySceneTest, TexturesAreReadAtTheNearestTexel) {
  TriangleMesh mesh{.vertices = {{0, 0, 0}, {2, 0, 0}, {2, 2, 0}, {0, 2, 0}},
                    .triangles = {{0, 1, 2}, {0, 2, 3}},
                    .texture_coordinates = {{0, 1}, {1, 1}, {1, 0}, {0, 0}},
                    .albedo = (cv::Mat_<cv::Vec3f>(2, 2) << cv::Vec3f(1, 0, 0), cv::Vec3f(0, 1, 0), cv::Vec3f(0, 0, 1),
                               cv::Vec3f(1, 1, 1))};
  const RayScene scene({.meshes = {mesh}});
  const auto albedo_at = [&](float x, float y) {
    return std::get<MeshPoint>(scene.intersect({{x, y, 5}, {0, 0, -1}})->point).albedo;
  };
  EXPECT_TRUE((albedo_at(0.1f, 1.9f) == Eigen::Array3f(1, 0, 0)).all());  // top left of the texture
  EXPECT_TRUE((albedo_at(0.95f, 1.05f) == Eigen::Array3f(1, 0, 0)).all());
  EXPECT_TRUE((albedo_at(1.05f, 1.05f) == Eigen::Array3f(0, 1, 0)).all());
  EXPECT_TRUE((albedo_at(0.1f, 0.1f) == Eigen::Array3f(0, 0, 1)).all());
}

TEST(RaySceneTest, MeshesAreSeenFromBothSides) {
  const TriangleMesh mesh{.vertices = {{-1, -1, 0}, {1, -1, 0}, {0, 2, 0}}, .triangles = {{0, 1, 2}}};
  const RayScene scene({.meshes = {mesh}});
  for (float side : {-1.0f, 1.0f}) {
    const auto hit = scene.intersect({{0, 0, 3 * side}, {0, 0, -side}});
    ASSERT_TRUE(hit);
    EXPECT_EQ(std::get<MeshPoint>(hit->point).normal.z(), side);
  }
}

}  // namespace
}  // namespace renderer

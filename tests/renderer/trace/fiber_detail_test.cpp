// What is seen of fibers close by: fibers that wind round threads, and fibers that stand out.
#include "renderer/scene/fiber_detail.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "renderer/trace/path_tracer.h"
#include "renderer/trace/path_vertex.h"
#include "tests/renderer/trace/cloth_scenes.h"

namespace renderer {
namespace {

using Eigen::Vector3f;

constexpr unsigned kFiberSeed = 20261130;
constexpr double kThreadRadius_mm = 0.2;
const FiberDetail kSpun{.twist_rad = 0.3, .spread_rad = 0.1, .shade = 0.2, .width_mm = 0.015};

struct Moments {
  double mean = 0, deviation = 0;
};
Moments moments(const std::vector<double>& values) {
  Moments m;
  for (const double value : values) m.mean += value / static_cast<double>(values.size());
  for (const double value : values) m.deviation += (value - m.mean) * (value - m.mean);
  m.deviation = std::sqrt(m.deviation / static_cast<double>(values.size()));
  return m;
}

TEST(FiberDetailTest, FibersDeviateAsMuchAsTheyAreToldTo) {
  std::mt19937 random(kFiberSeed);
  std::printf("seed %u\n", kFiberSeed);
  std::uniform_real_distribution<double> along(-500, 500), azimuth(-std::numbers::pi, std::numbers::pi);
  std::vector<double> turns, lifts, shades;
  for (int i = 0; i < 40000; ++i) {
    const FiberAt fiber = fiber_at(kSpun, along(random), azimuth(random), kThreadRadius_mm, random() % 50);
    turns.push_back(static_cast<double>(fiber.turn_rad));
    lifts.push_back(static_cast<double>(fiber.lift_rad));
    shades.push_back(static_cast<double>(fiber.shade));
  }
  EXPECT_NEAR(moments(turns).mean, kSpun.twist_rad, 0.003);
  EXPECT_NEAR(moments(turns).deviation, kSpun.spread_rad, 0.003);
  EXPECT_NEAR(moments(lifts).mean, 0, 0.001);
  EXPECT_NEAR(moments(shades).mean, 1, 0.005);
  EXPECT_NEAR(moments(shades).deviation, kSpun.shade, 0.005);
}

// The correlation of the shades at places of a thread's surface and beside them.
double correlation(double along_mm, double azimuth_rad) {
  std::mt19937 random(kFiberSeed);
  std::uniform_real_distribution<double> along(-50, 50), azimuth(-std::numbers::pi, std::numbers::pi);
  double products = 0, squares = 0;
  for (int i = 0; i < 20000; ++i) {
    const double z = along(random), angle = azimuth(random);
    const auto a = static_cast<double>(fiber_at(kSpun, z, angle, kThreadRadius_mm, 1).shade) - 1;
    const auto b =
        static_cast<double>(fiber_at(kSpun, z + along_mm, angle + azimuth_rad, kThreadRadius_mm, 1).shade) - 1;
    products += a * b, squares += a * a;
  }
  return products / squares;
}

TEST(FiberDetailTest, AFiberIsMetAgainAlongItsHelixAndNowhereElse) {
  const double step_mm = 0.1, round_rad = step_mm * std::tan(kSpun.twist_rad) / kThreadRadius_mm;
  EXPECT_GT(correlation(step_mm, round_rad), 0.9);
  EXPECT_LT(std::abs(correlation(step_mm, -round_rad)), 0.1);
  EXPECT_LT(std::abs(correlation(0, 1.5 * kSpun.width_mm / kThreadRadius_mm)), 0.1);
  EXPECT_LT(std::abs(correlation(5, 5 * std::tan(kSpun.twist_rad) / kThreadRadius_mm)), 0.1) << "it has gone inside";
}

TEST(FiberDetailTest, TheFrameIsThatOfTheFiber) {
  CurvePoint point{};
  point.tangent = Vector3f::UnitX(), point.normal = Vector3f::UnitZ();
  point.fiber.turn_rad = 0.4f;
  Eigen::Matrix3f frame = local_from_world(point);
  EXPECT_LT((frame.row(0).transpose() - Vector3f(std::cos(0.4f), std::sin(0.4f), 0)).norm(), 1e-6f);
  EXPECT_LT((frame.row(2).transpose() - Vector3f::UnitZ()).norm(), 1e-6f);
  point.fiber.lift_rad = 0.2f;
  frame = local_from_world(point);
  EXPECT_LT((frame * frame.transpose() - Eigen::Matrix3f::Identity()).norm(), 1e-6f);
  EXPECT_NEAR(frame.row(0).z(), std::sin(0.2f), 1e-6f);
}

Scene cloth_with(const std::optional<FiberDetail>& fibers, const std::optional<Flyaways>& flyaways,
                 const SwatchShape& swatch = {7.2, 5.4}) {
  YarnPatch patch = plain_patch();
  for (Yarn& yarn : patch.yarns) yarn.thread = 0;
  ThreadParameters red;
  red.sigma_a = {0.1, 1.2, 0.9};
  Scene scene = two_scale_scene(swatch, patch, {red});
  scene.cloths[0].fibers = fibers;
  scene.cloths[0].flyaways = flyaways;
  scene.surroundings = EnvironmentLight{.radiance = cv::Mat3f(8, 16, cv::Vec3f(1, 1, 1))};
  return scene;
}

cv::Mat3f picture_with(const Scene& scene) {
  const Camera camera = camera_on({0, 0, 300}, {0, 0, 0}, {0, 1, 0}, 7.2, 32, 24);
  return PathTracer(scene).render(camera, {.samples_per_pixel = 16});
}

TEST(FiberDetailTest, FibersThatAreTheThreadItselfChangeNoBit) {
  const cv::Mat3f smooth = picture_with(cloth_with({}, {}));
  EXPECT_EQ(cv::norm(smooth, picture_with(cloth_with(FiberDetail{}, {})), cv::NORM_INF), 0);
  EXPECT_EQ(cv::norm(smooth, picture_with(cloth_with({}, Flyaways{.per_mm = 0})), cv::NORM_INF), 0);
  EXPECT_GT(cv::norm(smooth, picture_with(cloth_with(kSpun, {})), cv::NORM_INF), 0.01);
}

TEST(FiberDetailTest, FlyawaysStandOutAsThoseOfExplicitCurvesDo) {
  const Flyaways many{.per_mm = 8, .length_mm = 0.8, .diameter_mm = 0.03};
  constexpr int kPeriods = 12;
  const YarnPatch plain = plain_patch();
  const SwatchShape swatch{kPeriods * plain.period_x_mm, kPeriods * plain.period_y_mm};
  const Scene scene = cloth_with({}, many, swatch);
  const YarnPatch& patch = scene.cloths[0].patch;
  const FlyawayCurves curves = flyaway_curves(patch, many);
  double wanted = 0;
  for (const Yarn& yarn : patch.yarns) wanted += many.per_mm * (yarn.warp ? patch.period_y_mm : patch.period_x_mm);
  ASSERT_EQ(curves.origins.size(), curves.curves.segments.size());
  EXPECT_GE(static_cast<double>(curves.curves.segments.size()), 6 * std::floor(wanted))
      << "six segments each, and images";

  const RayScene rays(scene);
  std::mt19937 random(kFiberSeed);
  std::uniform_real_distribution<float> u(-0.5f, 0.5f);
  const auto px = static_cast<float>(patch.period_x_mm), py = static_cast<float>(patch.period_y_mm);
  // The same as explicit curves, flyaways of all images for each period.
  Scene curves_of_all = brute_force_scene(swatch, patch, scene.cloths[0].threads);
  CurveSet all = curves.curves;
  all.control_points.clear(), all.segments.clear();
  for (int y = 0; y < kPeriods; ++y)
    for (int x = 0; x < kPeriods; ++x) {
      const auto first = static_cast<std::uint32_t>(all.control_points.size());
      const Eigen::Vector4f moved(px * static_cast<float>(x - kPeriods / 2), py * static_cast<float>(y - kPeriods / 2),
                                  0, 0);
      for (const Eigen::Vector4f& point : curves.curves.control_points) all.control_points.emplace_back(point + moved);
      for (const std::uint32_t segment : curves.curves.segments) all.segments.push_back(first + segment);
    }
  curves_of_all.curves.push_back(all);
  const auto flyaway_set = static_cast<int>(curves_of_all.curves.size()) - 1;
  const RayScene explicit_rays(curves_of_all);
  int of_flyaways = 0, different = 0;
  constexpr int kRays = 20000;
  for (int i = 0; i < kRays; ++i) {
    const Vector3f from(px * u(random), py * u(random), 20),
        down = Vector3f(0.4f * u(random), 0.4f * u(random), -1).normalized();
    const auto a = rays.intersect({from, down}), b = explicit_rays.intersect({from, down});
    const auto set = [](const auto& hit) {
      return hit ? static_cast<int>(std::get<CurvePoint>(hit->point).curve_set) : -1;
    };
    different += (set(a) == 1) != (set(b) == flyaway_set) || (a && b && std::abs(a->distance - b->distance) > 2e-3f);
    if (set(a) != 1) continue;
    ++of_flyaways;
    EXPECT_TRUE(rays.occluded({from, down}, a->distance + 0.01f));
    const auto yarn = rays.yarn_at({from, down});
    EXPECT_TRUE(yarn && yarn->group == 0);
  }
  std::printf("seed %u: %d of %d rays meet flyaways, %d another thing than of curves\n", kFiberSeed, of_flyaways, kRays,
              different);
  EXPECT_GT(of_flyaways, kRays / 50);
  EXPECT_LT(different, kRays / 1000);  // rays that only touch
}

}  // namespace
}  // namespace renderer

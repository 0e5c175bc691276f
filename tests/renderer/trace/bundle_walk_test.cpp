// Threads as bundles of fibers against threads whose fibers are curves of their own, placed by other seeds and met by
// Embree: the two share how one fiber scatters and how circles are placed, not how rays go among the fibers.
#include "renderer/trace/bundle_walk.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "renderer/scattering/fiber_bundle.h"
#include "renderer/trace/path_tracer.h"

namespace renderer {
namespace {

using Eigen::Array3d;
using Eigen::Vector3d;

constexpr double kRadius_mm = 0.25;
constexpr double kWave_mm = 1.8;  // of two crossings of plain weave
constexpr int kBundles = 256, kSamples = 24;
const BundleParameters kThread{
    .fiber_count = 20, .radius_ratio = 0.15, .fiber = {.sigma_a = {0.05, 0.4, 1.5}, .beta_m = 0.3, .beta_n = 0.35}};

struct Case {
  const char* name;
  int threads;      // side by side, touching
  double flatness;  // of their sections; the area stays
  Vector3d to_light;
  double crimp_mm = 0;  // height of the waves in which threads run, kWave_mm long, up at x = 0
};
void PrintTo(const Case& one, std::ostream* out) {
  *out << one.name;
}

// From threads as round curves along x.
Eigen::Affine3f flattened(double flatness) {
  const double root = std::sqrt(flatness);
  return Eigen::Affine3f(Eigen::Scaling(1.0f, static_cast<float>(root), static_cast<float>(1 / root)));
}

// A line at `at` (y, and across it and the thread) in the sections of a thread along x.
void add_line(CurveSet& set, const Eigen::Vector2d& at, double radius_mm, double crimp_mm) {
  constexpr int kPointsPerWave = 32;
  constexpr double kHalf_mm = 30;
  const auto y = static_cast<float>(at.x()), radius = static_cast<float>(radius_mm);
  // Straight lines in short pieces, which are met in less time.
  const double straight = kHalf_mm / std::ceil(kHalf_mm / (25 * radius_mm)),
               step = crimp_mm > 0 ? kWave_mm / kPointsPerWave : straight, k = 2 * std::numbers::pi / kWave_mm;
  std::vector<Eigen::Vector4f> points;
  for (double x = -kHalf_mm; x < kHalf_mm + step / 2; x += step) {
    const Eigen::Vector2d along = Eigen::Vector2d(1, -crimp_mm / 2 * k * std::sin(k * x)).normalized(),
                          up(-along.y(), along.x()),
                          place = Eigen::Vector2d(x, crimp_mm / 2 * std::cos(k * x)) + at.y() * up;
    points.push_back({static_cast<float>(place.x()), y, static_cast<float>(place.y()), radius});
  }
  set.add_clamped_curve(points);
}

// The place of thread number i in the plane across, before threads are flattened.
Eigen::Vector2d place_of(int i, const Case& of) {
  return {2 * kRadius_mm * (i - 0.5 * (of.threads - 1)), 0};
}

CurveSet as_bundles(const Case& of) {
  CurveSet set{.scattering = kThread};
  for (int i = 0; i < of.threads; ++i) add_line(set, place_of(i, of), kRadius_mm, of.crimp_mm);
  set.placed = flattened(of.flatness);
  return set;
}

CurveSet as_fibers(const Case& of, std::uint64_t seed) {
  CurveSet set{.scattering = kThread.fiber};
  const double fiber_radius = kThread.radius_ratio * kRadius_mm;
  for (int i = 0; i < of.threads; ++i) {
    std::vector<Eigen::Vector2d> fibers;
    for (std::uint64_t attempt = 0; fibers.size() < 20; ++attempt)
      fibers = pack_fibers(kRadius_mm, fiber_radius, 0, 2000, 20,
                           7919 * seed + 101 * static_cast<std::uint64_t>(i) + attempt, FiberPlacement::area_uniform,
                           of.flatness);
    const Eigen::Vector2d middle(std::sqrt(of.flatness) * place_of(i, of).x(), 0);
    for (const Eigen::Vector2d& fiber : fibers) add_line(set, middle + fiber, fiber_radius, of.crimp_mm);
  }
  return set;
}

// The mean radiance of a picture of the threads.
Array3d seen(const CurveSet& set, const Case& of, int samples, std::uint64_t seed) {
  const PathTracer tracer(
      {.curves = {set}, .lights = {{.center = 400 * of.to_light.normalized(), .radius_mm = 20, .visible = false}}});
  Camera camera = look_at({0, 0.3, 100}, Vector3d::Zero(), Vector3d::UnitX());
  camera.width = camera.height = 16;
  camera.cx = camera.cy = 7.5;
  const double half_width_mm = 1.05 * kRadius_mm * std::sqrt(of.flatness) * of.threads;
  camera.fx = camera.fy = 8 * 100 / half_width_mm;
  const cv::Scalar mean = cv::mean(tracer.render(camera, {.samples_per_pixel = samples, .seed = seed}));
  return {mean[0], mean[1], mean[2]};
}

class BundleWalkTest : public testing::TestWithParam<Case> {};

TEST_P(BundleWalkTest, AThreadLooksAsTheMeanOfThreadsWhoseFibersAreCurves) {
  const Case& of = GetParam();
  Array3d mean = Array3d::Zero(), square = Array3d::Zero();
  for (std::uint64_t seed = 1; seed <= kBundles; ++seed) {
    const Array3d one = seen(as_fibers(of, seed), of, kSamples, seed);
    mean += one / kBundles;
    square += one.square() / kBundles;
  }
  const Array3d error = ((square - mean.square()) / (kBundles - 1)).sqrt();
  // As many samples, and as many bundles for each of them to meet.
  const Array3d found = seen(as_bundles(of), of, kBundles * kSamples, 1), off = found / mean - 1;
  std::printf("%s: off by %+.2f %+.2f %+.2f %%, standard errors %.2f %.2f %.2f %%\n", of.name, 100 * off[0],
              100 * off[1], 100 * off[2], 100 * error[0] / mean[0], 100 * error[1] / mean[1], 100 * error[2] / mean[2]);
  EXPECT_LT((error / mean).maxCoeff(), 0.02) << "too noisy to see a bias of 8 %";
  EXPECT_LT(((found - mean) / error).abs().maxCoeff(), 4);
}

INSTANTIATE_TEST_SUITE_P(
    Threads, BundleWalkTest,
    testing::Values(Case{"LitInFront", 1, 1, {0.1, 0.5, 0.8}}, Case{"LitFromBehind", 1, 1, {0.1, 0.4, -0.9}},
                    Case{"LitAlong", 1, 1, {0.8, 0.2, 0.5}}, Case{"TouchingInFront", 3, 1, {0.1, 0.5, 0.8}},
                    Case{"TouchingFromBehind", 3, 1, {0.1, 0.4, -0.9}}, Case{"FlatInFront", 1, 2, {0.1, 0.5, 0.8}},
                    Case{"FlatFromBehind", 1, 2, {0.1, 0.4, -0.9}},
                    Case{"FlatTouchingFromBehind", 3, 2.4, {0.1, 0.4, -0.9}},
                    Case{"CrimpedInFront", 1, 1, {0.1, 0.5, 0.8}, 0.5},
                    Case{"CrimpedAlong", 1, 1, {0.8, 0.2, 0.5}, 0.5},
                    Case{"CrimpedFromBehind", 3, 1, {0.1, 0.4, -0.9}, 0.5}),
    [](const auto& test) { return std::string(test.param.name); });

TEST(BundleSectionsTest, HoldTheirFibersWithoutOverlapWithinTheSection) {
  for (const double flatness : {1.0, 2.5}) {
    const BundleSections sections(20, 0.15);
    for (int draw = 0; draw < sections.draws(); ++draw) {
      const CircleGrid& fibers = sections.section(flatness, draw);
      ASSERT_EQ(fibers.size(), 20U);
      for (int i = 0; i < 20; ++i) {
        const Eigen::Vector2d& at = fibers.center(i);
        const double wide = std::sqrt(1.1 * flatness) / 0.15, high = 1.1 / std::sqrt(flatness) / 0.15;
        EXPECT_LT(std::abs(at.x()) + 1, wide);
        EXPECT_LT(std::abs(at.y()) + 1, high);
        for (int j = 0; j < i; ++j) EXPECT_GE((at - fibers.center(j)).norm(), 2);
      }
    }
  }
}

TEST(BundleSectionsTest, HoldAFiberAsThickAsTheThreadEvenWhereItIsFlat) {
  EXPECT_EQ(BundleSections(1, 1).section(1, 0).size(), 1U);
  EXPECT_EQ(BundleSections(1, 1).section(3, 0).size(), 1U);
}

}  // namespace
}  // namespace renderer

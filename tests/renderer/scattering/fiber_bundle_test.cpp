#include "renderer/scattering/fiber_bundle.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace renderer {
namespace {

TEST(FiberBundleTest, FibersLieInsideTheThreadAndKeepTheirGaps) {
  const auto centers = pack_fibers(1.0, 0.1, 0.01, 1000, 100, 7);
  ASSERT_GT(centers.size(), 20u);
  for (std::size_t i = 0; i < centers.size(); ++i) {
    EXPECT_LE(centers[i].norm(), 0.9);
    for (std::size_t j = 0; j < i; ++j) EXPECT_GE((centers[i] - centers[j]).norm(), 0.21);
  }
}

TEST(FiberBundleTest, FibersLieInsideAFlatThreadAndFillItEvenly) {
  constexpr double kFlatness = 2.5, kFiber = 0.1;
  const double a = std::sqrt(kFlatness), b = 1 / a;
  int inner = 0, all = 0;
  for (std::uint64_t seed = 0; seed < 500; ++seed)
    for (const Eigen::Vector2d& center :
         pack_fibers(1.0, kFiber, 0.01, 100, 3, seed, FiberPlacement::area_uniform, kFlatness)) {
      double nearest = 1e9;  // of the ellipse to the centre
      for (int i = 0; i < 2000; ++i) {
        const double angle = 2 * std::numbers::pi * i / 2000;
        nearest = std::min(nearest, (Eigen::Vector2d(a * std::cos(angle), b * std::sin(angle)) - center).norm());
      }
      EXPECT_LT(std::hypot(center.x() / a, center.y() / b), 1);
      EXPECT_GT(nearest, kFiber - 1e-3);
      // Half of an ellipse's area lies within 0.40397 of its half width.
      inner += std::abs(center.x()) < 0.40397 * (a - kFiber), ++all;
    }
  EXPECT_GT(all, 1000);
  // The inner body is a little blunter than an ellipse of that width.
  EXPECT_NEAR(inner / static_cast<double>(all), 0.5, 0.06);
}

TEST(FiberBundleTest, TheSeedAloneDecidesTheBundle) {
  EXPECT_EQ(pack_fibers(1.0, 0.1, 0.01, 1000, 100, 7), pack_fibers(1.0, 0.1, 0.01, 1000, 100, 7));
  EXPECT_NE(pack_fibers(1.0, 0.1, 0.01, 1000, 100, 7), pack_fibers(1.0, 0.1, 0.01, 1000, 100, 8));
}

TEST(FiberBundleTest, StopsAtTheNumberOfFibersAskedFor) {
  EXPECT_EQ(pack_fibers(1.0, 0.1, 0.01, 1000, 12, 7).size(), 12u);
}

TEST(FiberBundleTest, AFiberThickerThanTheThreadDoesNotFit) {
  EXPECT_TRUE(pack_fibers(1.0, 1.1, 0, 1000, 12, 7).empty());
  EXPECT_EQ(pack_fibers(1.0, 1.0, 0, 1000, 12, 7).size(), 1u);
}

TEST(FiberBundleTest, FirstFibersAreUniformOverTheArea) {
  int inner = 0;
  constexpr int kBundles = 4000;
  for (int seed = 0; seed < kBundles; ++seed)
    inner += pack_fibers(1.0, 0.1, 0, 1, 1, static_cast<std::uint64_t>(seed)).front().norm() < 0.9 / std::sqrt(2.0);
  EXPECT_NEAR(inner, kBundles / 2, 4 * std::sqrt(kBundles) / 2);  // four standard deviations of a fair coin
}

}  // namespace
}  // namespace renderer

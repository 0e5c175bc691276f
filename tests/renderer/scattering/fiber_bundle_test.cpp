#include "renderer/scattering/fiber_bundle.h"

#include <gtest/gtest.h>

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

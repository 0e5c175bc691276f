#include "inversion/solve/robust_weights.h"

#include <gtest/gtest.h>

namespace inversion {
namespace {

WeighedView even_view(double misfit, bool transmission = false) {
  return {.transmission = transmission, .mean_reference = 1, .misfits = std::vector<double>(10, misfit)};
}

TEST(RobustWeightsTest, ViewsThatAgreeAlikeCountInFull) {
  const RobustWeights weights = robust_weights({even_view(0.1), even_view(0.12), even_view(0.25)});
  for (double weight : weights.views) EXPECT_EQ(weight, 1);
  for (const auto& blocks : weights.blocks)
    for (double weight : blocks) EXPECT_EQ(weight, 1);
}

TEST(RobustWeightsTest, AViewTenTimesWorseThanTheOthersHardlyCounts) {
  const RobustWeights weights = robust_weights({even_view(0.1), even_view(0.1), even_view(0.1), even_view(1)});
  EXPECT_EQ(weights.views[0], 1);
  EXPECT_NEAR(weights.views[3], 0.00390625, 1e-12);  // (2.5 / 10)^4
  EXPECT_NEAR(weights.blocks[3][0], 0.00390625, 1e-12);
}

TEST(RobustWeightsTest, ReflectionsAndTransmissionsAreJudgedAmongThemselves) {
  const RobustWeights weights =
      robust_weights({even_view(0.01), even_view(0.01), even_view(0.5, true), even_view(0.5, true)});
  for (double weight : weights.views) EXPECT_EQ(weight, 1);
}

TEST(RobustWeightsTest, ABlockThatIsFarOffWithinItsViewHardlyCounts) {
  WeighedView view = even_view(0.1);
  view.misfits[4] = 0.5;
  const RobustWeights weights = robust_weights({view, even_view(0.1)});
  EXPECT_NEAR(weights.blocks[0][4], 0.25, 1e-12);  // (2.5 / 5)^2
  EXPECT_EQ(weights.blocks[0][5], 1);
}

TEST(RobustWeightsTest, NoiseLowersABlockBelowItsLike) {
  WeighedView view = even_view(0.1);
  view.noise_variances = std::vector<double>(10, 0);
  view.noise_variances[2] = 0.03;
  EXPECT_NEAR(robust_weights({view}).blocks[0][2], 0.25, 1e-12);  // 0.01 of 0.04
}

TEST(RobustWeightsTest, ADimViewIsJudgedByWhatIsUsual) {
  WeighedView dim = even_view(0.01);
  dim.mean_reference = 0.01;  // 100 % off, which is little beside the others
  for (double weight : robust_weights({even_view(0.1), even_view(0.1), dim}).views) EXPECT_EQ(weight, 1);
}

TEST(RobustWeightsTest, PerfectViewsAndDarkOnesAreNoTrouble) {
  WeighedView dark = even_view(0);
  dark.mean_reference = 0;
  for (double weight : robust_weights({dark, even_view(0)}).views) EXPECT_EQ(weight, 1);
  EXPECT_TRUE(robust_weights({}).views.empty());
}

}  // namespace
}  // namespace inversion

#include "inversion/fit/noise_weights.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

namespace inversion {
namespace {

using Eigen::VectorXd;

constexpr int kGroups = 12, kOfGroup = 40, kResiduals = kGroups * kOfGroup;

// Groups whose noise differs by factors of ten in variance, and a misfit that is alike everywhere.
class NoisyResiduals {
 public:
  NoisyResiduals(double misfit_variance, std::uint32_t seed) : random_(seed), misfit_(kResiduals), groups_(kResiduals) {
    std::normal_distribution<double> normal;
    for (int i = 0; i < kResiduals; ++i) {
      groups_[static_cast<std::size_t>(i)] = i / kOfGroup;
      misfit_[i] = std::sqrt(misfit_variance) * normal(random_);
    }
  }
  const std::vector<int>& groups() const { return groups_; }
  static double variance(int residual) { return std::pow(10.0, -(residual / kOfGroup) / 2.0 - 3); }
  void add_set(NoiseWeights& weights) {
    std::normal_distribution<double> normal;
    std::chi_squared_distribution<double> chi2(3);  // a variance from few paths
    VectorXd variances(kResiduals), products(kResiduals);
    for (int i = 0; i < kResiduals; ++i) {
      const double of_half = std::sqrt(2 * variance(i));
      variances[i] = variance(i) * chi2(random_) / 3;
      products[i] = (misfit_[i] + of_half * normal(random_)) * (misfit_[i] + of_half * normal(random_));
    }
    weights.add(variances, products);
  }

 private:
  std::mt19937 random_;
  VectorXd misfit_;
  std::vector<int> groups_;
};

TEST(NoiseWeightsTest, WithoutMisfitResidualsCountByTheirNoise) {
  NoisyResiduals residuals(0, 1);
  NoiseWeights weights(residuals.groups());
  for (int set = 0; set < 4; ++set) residuals.add_set(weights);
  EXPECT_LT(weights.misfit_variance(), 1e-5);
  const VectorXd factors = weights.factors();
  const double loud = factors[0], quiet = factors[4 * kOfGroup];
  EXPECT_NEAR(quiet / loud, 10, 2);
  EXPECT_LT(factors.maxCoeff() / loud, 100);  // 560 by the noise alone: no residual counts for all
}

TEST(NoiseWeightsTest, AMisfitAboveTheNoiseLeavesEquation6AsItIs) {
  constexpr double kMisfit = 0.05;
  NoisyResiduals residuals(kMisfit, 2);
  NoiseWeights weights(residuals.groups());
  for (int set = 0; set < 4; ++set) residuals.add_set(weights);
  EXPECT_NEAR(weights.misfit_variance(), kMisfit, 0.2 * kMisfit);
  EXPECT_LT(weights.factors().maxCoeff() / weights.factors().minCoeff(), 1.05);
}

TEST(NoiseWeightsTest, AMisfitBetweenLoudAndQuietNoiseIsFound) {
  constexpr double kMisfit = 1e-5;
  NoisyResiduals residuals(kMisfit, 3);
  NoiseWeights weights(residuals.groups());
  for (int set = 0; set < 4; ++set) residuals.add_set(weights);
  EXPECT_NEAR(weights.misfit_variance(), kMisfit, 0.3 * kMisfit);
}

TEST(NoiseWeightsTest, PhotographsNoiseAndMisfitAreAlikeInAllSetsOfPaths) {
  constexpr double kShare = 0.25;  // of the noise, the photographs'
  NoisyResiduals explained(0, 7), misfitting(0.05, 8);
  NoiseWeights weights(explained.groups()), of_misfit(misfitting.groups());
  for (int set = 0; set < 20; ++set) explained.add_set(weights), misfitting.add_set(of_misfit);
  const auto alike = [&](const NoiseWeights& all, double share) {
    VectorXd photographs(kResiduals);
    for (int i = 0; i < kResiduals; ++i) photographs[i] = share * NoisyResiduals::variance(i);
    return all.variance_alike(photographs) / all.weighted_variance();
  };
  EXPECT_NEAR(alike(weights, 1), 1, 0.03);
  EXPECT_LT(alike(weights, 0), 0.4);  // groups whose noise is below the least misfit that is taken
  EXPECT_NEAR(alike(weights, kShare), alike(weights, 0) + kShare * (alike(weights, 1) - alike(weights, 0)), 0.03);
  EXPECT_NEAR(alike(of_misfit, 0), 1, 0.03);
}

TEST(NoiseWeightsTest, WhatOneBadStepAddsIsGoneWithTheNext) {
  NoisyResiduals good(0, 4), bad(0.05, 5);
  NoiseWeights weights(good.groups());
  good.add_set(weights);
  bad.add_set(weights);
  EXPECT_LT(weights.misfit_variance(), 1e-5);
  good.add_set(weights);
  EXPECT_LT(weights.misfit_variance(), 1e-5);
}

// The mean of residuals weighted so is as certain as weighting by the true variances makes it.
TEST(NoiseWeightsTest, AMeanIsNearlyAsCertainAsItCanBe) {
  NoisyResiduals residuals(0, 6);
  NoiseWeights weights(residuals.groups());
  for (int set = 0; set < 4; ++set) residuals.add_set(weights);
  const VectorXd by = weights.factors().cwiseAbs2();
  double spread = 0, best = 0, unweighted = 0;
  for (int i = 0; i < kResiduals; ++i) {
    spread += by[i] * by[i] * residuals.variance(i);
    best += 1 / residuals.variance(i);
    unweighted += residuals.variance(i);
  }
  spread = std::sqrt(spread) / by.sum();
  best = 1 / std::sqrt(best), unweighted = std::sqrt(unweighted) / kResiduals;
  EXPECT_LT(spread, 4 * best);
  EXPECT_GT(unweighted, 20 * spread);
}

}  // namespace
}  // namespace inversion

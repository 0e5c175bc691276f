#include "rig/simulated/noise.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

TEST(Noise, SmallCountsFollowThePoissonLaw) {
  constexpr double kMean = 3;
  constexpr int kDraws = 200'000, kBins = 9;  // the last bin takes the tail
  rig::NoiseStream noise(7, 1);
  std::array<double, kBins> seen{};
  for (int i = 0; i < kDraws; ++i)
    seen[static_cast<std::size_t>(std::min(noise.small_poisson(kMean), kBins - 1.0))] += 1;
  double chi_square = 0, probability = std::exp(-kMean), rest = 1;
  for (int count = 0; count < kBins; ++count) {
    const double expected = kDraws * (count + 1 < kBins ? probability : rest);
    chi_square += std::pow(seen[static_cast<std::size_t>(count)] - expected, 2) / expected;
    rest -= probability;
    probability *= kMean / (count + 1);
  }
  EXPECT_LT(chi_square, 26.1);  // 8 degrees of freedom: exceeded once in a thousand seeds
}

TEST(Noise, NormalNumbersHaveUnitVarianceAndArePairwiseIndependent) {
  constexpr int kDraws = 200'000;
  rig::NoiseStream noise(7, 2);
  double sum = 0, squares = 0, products = 0, fourth = 0;
  for (int i = 0; i < kDraws; ++i) {
    const auto [a, b] = noise.normals();
    sum += a + b;
    squares += a * a + b * b;
    products += a * b;
    fourth += std::pow(a, 4);
  }
  // Five standard errors of each estimate.
  EXPECT_NEAR(sum / (2 * kDraws), 0, 5 / std::sqrt(2.0 * kDraws));
  EXPECT_NEAR(squares / (2 * kDraws), 1, 5 / std::sqrt(1.0 * kDraws));
  EXPECT_NEAR(products / kDraws, 0, 5 / std::sqrt(1.0 * kDraws));
  EXPECT_NEAR(fourth / kDraws, 3, 5 * std::sqrt(96.0 / kDraws));  // Var(a^4) = 105 - 9
}

TEST(Noise, StreamsDifferAndRepeat) {
  rig::NoiseStream one(7, 1), again(7, 1), other(7, 2), seeded(8, 1);
  const double first = one.uniform();
  EXPECT_EQ(first, again.uniform());
  EXPECT_NE(first, other.uniform());
  EXPECT_NE(first, seeded.uniform());
}

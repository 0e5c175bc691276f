#include "inversion/fit/thread_unknowns.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "inversion/fit/fit_views.h"
#include "tests/inversion/fit/synthetic_spool.h"

namespace inversion {
namespace {

using renderer::kThreadParameterCount;
using renderer::ThreadParameters;

ThreadUnknowns values_of(const ThreadParameters& p) {
  ThreadUnknowns values;
  values << p.sigma_a, p.alpha[0], p.alpha[1], p.alpha[2], p.beta[0], p.beta[1], p.beta[2], p.r0a, p.r0b, p.r0c, p.r1a,
      p.r2a, p.r2b, p.r2c;
  return values;
}

// Anywhere within the bounds, and on them now and then.
ThreadUnknowns drawn_unknowns(std::mt19937& random) {
  const ThreadUnknowns low = lower_bounds(), high = upper_bounds();
  std::uniform_real_distribution<double> uniform(-0.2, 1.2);
  ThreadUnknowns unknowns;
  for (int k = 0; k < kThreadParameterCount; ++k)
    unknowns[k] = low[k] + (high[k] - low[k]) * std::clamp(uniform(random), 0.0, 1.0);
  return unknowns;
}

TEST(ThreadUnknownsTest, ParametersWithinTheBoundsComeBack) {
  for (const ThreadParameters& p : {known_thread(), starting_thread(), ThreadParameters{}}) {
    const ThreadParameters back = parameters_of(unknowns_of(p));
    EXPECT_LT((values_of(back) - values_of(p)).cwiseAbs().maxCoeff(), 1e-13);
  }
}

TEST(ThreadUnknownsTest, UnknownsComeBackFromTheirParameters) {
  std::mt19937 random(1);
  for (int i = 0; i < 1000; ++i) {
    const ThreadUnknowns u = drawn_unknowns(random);
    // 1 / (r2a + r2b) is up to 100 and cancels; 1e-12 of it is rounding.
    EXPECT_LT((unknowns_of(parameters_of(u)) - u).cwiseAbs().maxCoeff(), 1e-10);
  }
}

TEST(ThreadUnknownsTest, NoLobeWithinTheBoundsHasNegativeEnergyAtAnyAngle) {
  std::mt19937 random(2);
  for (int i = 0; i < 1000; ++i) {
    const ThreadParameters p = parameters_of(drawn_unknowns(random));
    for (int k = 0; k <= 50; ++k)
      for (double lambda : energies_at(p, k / 50.0)) ASSERT_GE(lambda, -1e-12) << "c = " << k / 50.0;  // rounding
  }
}

TEST(ThreadUnknownsTest, WithinTheBoundsLambda0IsConcaveAndLambda2Falls) {
  std::mt19937 random(3);
  for (int i = 0; i < 1000; ++i) {
    const ThreadParameters p = parameters_of(drawn_unknowns(random));
    for (int k = 1; k < 50; ++k) {
      const auto before = energies_at(p, (k - 1) / 50.0), at = energies_at(p, k / 50.0),
                 after = energies_at(p, (k + 1) / 50.0);
      ASSERT_GE(2 * at[0] - before[0] - after[0], -1e-12);
      ASSERT_GE(at[2] - after[2], -1e-12);
    }
  }
}

TEST(ThreadUnknownsTest, TheUnknownsAreLambdasAtTheEnds) {
  const ThreadParameters p = known_thread();
  const ThreadUnknowns u = unknowns_of(p);
  EXPECT_NEAR(u[9], energies_at(p, 0)[0], 1e-14);
  EXPECT_NEAR(u[10], energies_at(p, 1)[0], 1e-14);
  EXPECT_NEAR(u[12], energies_at(p, 1)[1], 1e-14);
  EXPECT_NEAR(u[15], energies_at(p, 1)[2], 1e-14);
}

TEST(ThreadUnknownsTest, ParametersOutsideTheBoundsAreBroughtToThem) {
  ThreadParameters p = known_thread();
  p.sigma_a[1] = -0.3;
  p.alpha[0] = 0.001;
  p.beta[2] = 1.4;
  p.r0a = 0.3, p.r0b = -1.2;  // convex and negative at c = 1
  p.r2b = 0;
  p.r2c = -1;
  const ThreadUnknowns u = unknowns_of(p);
  EXPECT_TRUE((u.array() >= lower_bounds().array()).all());
  EXPECT_TRUE((u.array() <= upper_bounds().array()).all());
  const ThreadParameters near = parameters_of(u);
  EXPECT_EQ(near.sigma_a[1], 0);
  EXPECT_EQ(near.beta[2], 1);
  EXPECT_EQ(near.sigma_a[0], p.sigma_a[0]);
  EXPECT_NEAR(energies_at(near, 0)[0], p.r0c, 1e-14);
}

TEST(ThreadUnknownsTest, ATintComesBackAndLambda0IsThatOfTheStrongestChannel) {
  ThreadParameters p = known_thread();
  p.lambda0_rgb = {0.4, 0.7, 1};
  const Eigen::VectorXd u = tinted_unknowns_of(p);
  ASSERT_EQ(u.size(), kTintedCount);
  EXPECT_NEAR(u[kL0], 0.7 * p.r0c, 1e-14);
  const ThreadParameters back = tinted_parameters_of(u);
  EXPECT_TRUE(back.lambda0_rgb.isApprox(p.lambda0_rgb, 1e-14)) << back.lambda0_rgb.transpose();
  EXPECT_LT((values_of(back) - values_of(p)).cwiseAbs().maxCoeff(), 1e-13);
}

TEST(ThreadUnknownsTest, TheJacobianIsThatOfFiniteDifferences) {
  std::mt19937 random(4);
  for (int i = 0; i < 20; ++i) {
    const ThreadUnknowns u = drawn_unknowns(random);
    const ThreadJacobian found = parameters_by_unknowns(u);
    for (int k = 0; k < kThreadParameterCount; ++k) {
      constexpr double kStep = 1e-6;  // balances the step's square, over that of the least w2, and rounding
      const ThreadUnknowns step = kStep * ThreadUnknowns::Unit(k);
      const ThreadUnknowns expected =
          (values_of(parameters_of(u + step)) - values_of(parameters_of(u - step))) / (2 * kStep);
      for (int row = 0; row < kThreadParameterCount; ++row)  // r2 reach 1e4: rounding of 1e-12 over the step
        EXPECT_NEAR(found(row, k), expected[row], 1e-7 + 1e-7 * std::abs(expected[row])) << row << " by " << k;
    }
  }
}

TEST(ThreadUnknownsTest, EveryUnknownBelongsToTheGroupOfItsName) {
  const std::array<const char*, kThreadParameterCount> expected{
      "sigma_a", "sigma_a", "sigma_a", "alpha", "alpha", "alpha", "beta", "beta",
      "beta",    "r",       "r",       "r",     "r",     "r",     "r",    "r"};
  for (int k = 0; k < kThreadParameterCount; ++k)
    EXPECT_EQ(name_of(group_of(k)), expected[static_cast<std::size_t>(k)]) << k;
}

}  // namespace
}  // namespace inversion

#include "inversion/fit/step_coordinates.h"

#include <gtest/gtest.h>

#include <random>

namespace inversion {
namespace {

using Eigen::VectorXd;

const FamilyUnknowns& family() {
  static const FamilyUnknowns unknowns = unknowns_of(ThreadFamily{});
  return unknowns;
}

VectorXd unknowns_drawn(std::mt19937& random) {
  std::uniform_real_distribution<double> share(0.05, 0.95);
  VectorXd unknowns = family().lower;
  for (double& unknown : unknowns.segment<3>(kSigma)) unknown += share(random);
  for (Eigen::Index k = kAlpha; k < unknowns.size(); ++k)
    unknowns[k] += share(random) * (family().upper[k] - family().lower[k]);
  return unknowns;
}

TEST(StepCoordinatesTest, LeadBackToTheUnknownsWithTheSlopesThatTheySay) {
  constexpr double kStep = 1e-6;
  const StepCoordinates coordinates(family());
  std::mt19937 random(20261125);
  for (int draw = 0; draw < 100; ++draw) {
    const VectorXd unknowns = unknowns_drawn(random), at = coordinates.of(unknowns);
    EXPECT_LT((coordinates.unknowns(at) - unknowns).cwiseAbs().maxCoeff(), 1e-12);
    const VectorXd ones = VectorXd::Constant(at.size(), kStep);
    const VectorXd differences = (coordinates.unknowns(at + ones) - coordinates.unknowns(at - ones)) / (2 * kStep);
    EXPECT_LT((coordinates.slopes(unknowns) - differences).cwiseAbs().maxCoeff(), 1e-6);
  }
}

TEST(StepCoordinatesTest, KeepBounds) {
  const StepCoordinates coordinates(family());
  const VectorXd beyond = coordinates.of(family().upper) + VectorXd::Constant(family().upper.size(), 3);
  EXPECT_EQ(coordinates.unknowns(beyond), family().upper);
}

// The curvature of a loss that is a parabola in log s.
TEST(StepCoordinatesTest, ANewtonStepFromAWideLobeGoesToAParabolasMinimum) {
  const StepCoordinates coordinates(family());
  VectorXd wide = family().starts.front(), narrow = wide;
  wide[kBeta + 1] = 0.9, narrow[kBeta + 1] = 0.5;
  const VectorXd apart = coordinates.of(wide) - coordinates.of(narrow);
  const double by = 1 / coordinates.slopes(wide)[kBeta + 1];
  BiasFreeTerms terms{.gradient = VectorXd::Zero(wide.size()),
                      .hessian = Eigen::MatrixXd::Zero(wide.size(), wide.size())};
  terms.gradient[kBeta + 1] = by * apart[kBeta + 1];
  terms.hessian(kBeta + 1, kBeta + 1) = by * by;
  const BiasFreeTerms there = coordinates.of(terms, wide);
  VectorXd at = coordinates.of(wide);
  at[kBeta + 1] -= there.gradient[kBeta + 1] / there.hessian(kBeta + 1, kBeta + 1);
  EXPECT_NEAR(coordinates.unknowns(at)[kBeta + 1], 0.5, 1e-9);
}

TEST(StepManifoldTest, StepsAndTheirJacobiansAgreeAndHeldUnknownsStay) {
  constexpr int kHeld = kAlpha + 1;
  constexpr double kStep = 1e-6;
  const auto count = static_cast<int>(family().lower.size());
  const StepManifold manifold(StepCoordinates(family()), count, {kHeld});
  ASSERT_EQ(manifold.TangentSize(), count - 1);
  std::mt19937 random(7);
  const VectorXd at = unknowns_drawn(random);
  VectorXd step = VectorXd::Constant(count - 1, 0.003), there(count), back(count - 1);
  ASSERT_TRUE(manifold.Plus(at.data(), step.data(), there.data()));
  EXPECT_EQ(there[kHeld], at[kHeld]);
  ASSERT_TRUE(manifold.Minus(there.data(), at.data(), back.data()));
  EXPECT_LT((back - step).cwiseAbs().maxCoeff(), 1e-12);

  using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  RowMajor plus(count, count - 1), minus(count - 1, count);
  ASSERT_TRUE(manifold.PlusJacobian(at.data(), plus.data()));
  ASSERT_TRUE(manifold.MinusJacobian(at.data(), minus.data()));
  EXPECT_LT((minus * plus - Eigen::MatrixXd::Identity(count - 1, count - 1)).cwiseAbs().maxCoeff(), 1e-12);
  for (int k = 0; k < count - 1; ++k) {
    VectorXd one = VectorXd::Zero(count - 1), more(count), less(count);
    one[k] = kStep;
    manifold.Plus(at.data(), one.data(), more.data());
    one[k] = -kStep;
    manifold.Plus(at.data(), one.data(), less.data());
    EXPECT_LT(((more - less) / (2 * kStep) - plus.col(k)).cwiseAbs().maxCoeff(), 1e-6) << k;
  }
}

}  // namespace
}  // namespace inversion

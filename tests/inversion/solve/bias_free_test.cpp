// Straight problems whose residuals and Jacobians are both noisy, as estimated pictures are.
#include "inversion/solve/bias_free.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <array>
#include <cmath>
#include <cstdio>
#include <random>

#include "inversion/solve/joined_sets.h"

namespace inversion {
namespace {

using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;

constexpr double kNoise = 0.05, kJacobianNoise = 0.2, kApart = 0.3;
constexpr Eigen::Index kRows = 600;

class NoisyProblem {
 public:
  explicit NoisyProblem(std::uint32_t seed) : random_(seed), jacobian_(noise(1)) {
    jacobian_.col(1) = 2 * jacobian_.col(0) + kApart * jacobian_.col(1);  // they trade off
  }
  // The terms of all sets so far, with one more traced at x.
  BiasFreeTerms terms_at(const VectorXd& x, double old) {
    std::array<MatrixXd, 2> jacobians;
    std::array<VectorXd, 2> residuals;
    for (std::size_t h = 0; h < 2; ++h) {
      jacobians[h] = jacobian_ + noise(kJacobianNoise);
      residuals[h] = jacobians[h] * (x - truth()) + noise(kNoise).col(0);
    }
    sets_.add(residuals, jacobians, x, old);
    return sets_.at(x);
  }
  static Vector3d truth() { return {0.3, 0.5, -0.2}; }
  double squared_distance(const VectorXd& x) const { return (jacobian_ * (x - truth())).squaredNorm(); }
  // The mean of squared_distance by one set alone, whose gradient errs by (J_A' n_B + J_B' n_A) / 2.
  double expected_of_one_set() const {
    const MatrixXd hessian = jacobian_.transpose() * jacobian_;
    return kNoise * kNoise / 2 * (3 + kRows * kJacobianNoise * kJacobianNoise * hessian.inverse().trace());
  }

 private:
  MatrixXd noise(double deviation) {
    std::normal_distribution<double> normal(0, deviation);
    return MatrixXd::NullaryExpr(kRows, 3, [&] { return normal(random_); });
  }
  std::mt19937 random_;
  MatrixXd jacobian_;
  JoinedSets sets_;
};

BiasFreeOptions wide() {
  return {.lower = Vector3d::Constant(-2), .upper = Vector3d::Constant(2)};
}

TEST(BiasFreeTest, EndsAsNearAsAllItsSetsOfPathsTogetherCanTellThoughItBeginsFarAway) {
  constexpr int kProblems = 200;
  double met = 0, expected = 0;
  const BiasFreeOptions options = wide();
  const double sets = 1 + options.joint_steps;
  for (std::uint32_t seed = 1; seed <= kProblems; ++seed) {
    NoisyProblem problem(seed);
    VectorXd x = NoisyProblem::truth() + Vector3d(0.1, -0.2, 0.7);
    minimise_bias_free([&](int, const VectorXd& at, double old) { return problem.terms_at(at, old); }, options, x);
    met += problem.squared_distance(x);
    expected += problem.expected_of_one_set() / sets;
  }
  std::printf("squared distance %.3f of what %.0f sets of paths allow\n", met / expected, sets);
  EXPECT_LT(met, 1.25 * expected);
}

TEST(BiasFreeTest, HoldsWhatIsHeldAndMakesUpForWhatIsAtABound) {
  NoisyProblem problem(7);
  BiasFreeOptions options = wide();
  options.held = {2};
  options.upper[1] = 0.4;
  VectorXd x = NoisyProblem::truth() + Vector3d(-0.1, -0.2, 0);
  minimise_bias_free([&](int, const VectorXd& at, double old) { return problem.terms_at(at, old); }, options, x);
  EXPECT_EQ(x[2], NoisyProblem::truth()[2]);
  EXPECT_EQ(x[1], 0.4);
  EXPECT_NEAR(x[0], NoisyProblem::truth()[0] + 2 * 0.1, 0.02);
}

// A wall that begins between the places where paths were traced: the mean of its slopes there is not its slope here.
TEST(BiasFreeTest, TermsThatAreExactCountWhereTheStepBegins) {
  constexpr double kWall = 0.45, kSteepness = 1e6;
  NoisyProblem problem(11);
  BiasFreeOptions options = wide();
  options.held = {0};
  options.exact = [](const VectorXd& x) {
    BiasFreeTerms terms{.gradient = VectorXd::Zero(3), .hessian = MatrixXd::Zero(3, 3)};
    const double beyond = x[1] - kWall;
    if (beyond <= 0) return terms;
    terms.loss = kSteepness * beyond * beyond / 2;
    terms.gradient[1] = kSteepness * beyond;
    terms.hessian(1, 1) = kSteepness;
    return terms;
  };
  VectorXd x = NoisyProblem::truth() + Vector3d(0, -0.3, 0);
  minimise_bias_free([&](int, const VectorXd& at, double old) { return problem.terms_at(at, old); }, options, x);
  EXPECT_NEAR(x[1], kWall, 0.06);
}

double most(const VectorXd& values) {
  return values.size() ? values.maxCoeff() : 0;
}

// A step is least among random ones near it that keep the bounds, in problems drawn at random whose limits cross.
TEST(BiasFreeTest, AStepBetweenLimitsIsTheLeast) {
  constexpr int kProblems = 300, kUnknowns = 6, kLimits = 9, kOthers = 200;
  constexpr std::uint32_t kSeed = 20261127;
  std::printf("seed %u\n", kSeed);
  std::mt19937 random(kSeed);
  std::normal_distribution<double> normal;
  const auto drawn = [&](Eigen::Index rows, Eigen::Index columns) {
    return MatrixXd(MatrixXd::NullaryExpr(rows, columns, [&] { return normal(random); }));
  };
  int held_back = 0;
  for (int i = 0; i < kProblems; ++i) {
    // As unlike in steepness as the fit's valleys and walls.
    const VectorXd scales = drawn(kUnknowns, 1).unaryExpr([](double x) { return std::pow(10, 2 * x); });
    const MatrixXd root = scales.asDiagonal() * drawn(kUnknowns, kUnknowns),
                   limit_rows = 1e3 * drawn(kLimits, kUnknowns);
    const MatrixXd hessian = root.transpose() * root;
    const VectorXd gradient = hessian * drawn(kUnknowns, 1), limit_values = 300 * drawn(kLimits, 1);
    const auto loss = [&](const VectorXd& x) {
      return gradient.dot(x) + 0.5 * x.dot(hessian * x) +
             0.5 * (limit_values + limit_rows * x).cwiseMax(0).squaredNorm();
    };
    BiasFreeOptions options{.lower = VectorXd::Constant(kUnknowns, -1), .upper = VectorXd::Constant(kUnknowns, 0.5)};
    options.limits = [&](const VectorXd& at) {
      return BiasFreeOptions::Limits{limit_values + limit_rows * at, limit_rows};
    };
    options.approach_steps = 1, options.joint_steps = 0, options.longest = 2;
    VectorXd x = VectorXd::Zero(kUnknowns);
    minimise_bias_free(
        [&](int, const VectorXd& at, double) {
          return BiasFreeTerms{.loss = 0, .gradient = gradient + hessian * at, .hessian = hessian};
        },
        options, x);
    held_back += most(limit_values + limit_rows * x) > -1;
    const double least = loss(x), scale = std::max(1e-9, std::abs(least));
    ASSERT_LE(least, loss(VectorXd::Zero(kUnknowns))) << i;
    for (int k = 0; k < kOthers; ++k) {
      const double near = std::pow(10, -1 - 3.0 * k / kOthers);
      const VectorXd other = (x + near * drawn(kUnknowns, 1)).cwiseMax(options.lower).cwiseMin(options.upper);
      ASSERT_GE(loss(other), least - 1e-4 * scale) << i;
    }
  }
  EXPECT_GT(held_back, kProblems / 2);
}

TEST(BiasFreeTest, ALimitLetsGoOfWhatBeganBeyondIt) {
  constexpr double kSteepness = 1e6;
  BiasFreeOptions options = wide();
  options.limits = [=](const VectorXd& x) {
    return BiasFreeOptions::Limits{VectorXd::Constant(1, kSteepness * (x[0] - 0.5)),
                                   kSteepness * Eigen::RowVector3d::UnitX()};
  };
  options.approach_steps = 1, options.joint_steps = 0, options.longest = 2;
  VectorXd x = Vector3d(0.6, 0, 0);
  const auto towards_zero = [](int, const VectorXd& at, double) {
    return BiasFreeTerms{.gradient = at, .hessian = MatrixXd::Identity(3, 3)};
  };
  minimise_bias_free(towards_zero, options, x);
  EXPECT_NEAR(x[0], 0, 1e-5);
}

TEST(BiasFreeTest, WhatIsLeftOfTheStartIsWhatAnotherStartChanges) {
  const Vector3d curvatures{1, 0.05, 2}, truth{0.3, 0.5, -1.4};  // the second is hardly told, the third ends at a bound
  const auto terms_at = [&](int, const VectorXd& at, double) {
    return BiasFreeTerms{
        .gradient = curvatures.cwiseProduct(at - truth), .hessian = curvatures.asDiagonal(), .variance = 0.01};
  };
  BiasFreeOptions options{.lower = Vector3d::Constant(-1), .upper = Vector3d::Constant(1), .joint_steps = 2};
  options.approach_steps = 2;
  VectorXd one = Vector3d{0.25, 0.45, -0.95}, other = Vector3d{0.28, 0.51, -0.97};
  const VectorXd apart = other - one;
  const BiasFreeEnd end = minimise_bias_free(terms_at, options, one);
  minimise_bias_free(terms_at, options, other);
  EXPECT_TRUE((other - one).isApprox(end.left * apart, 1e-6)) << other - one << "\n" << end.left * apart;
  EXPECT_GT(end.left(1, 1), 0.5);
  EXPECT_EQ(end.left.row(2), Eigen::RowVector3d::Zero());
}

TEST(BiasFreeTest, GainIsHowFarAGradientThatIsGreaterInAllStepsMovesTheEndBack) {
  const Vector3d curvatures{1, 0.05, 2}, truth{0.3, 0.5, -1.4}, more{0.02, -0.01, 0.03};
  BiasFreeOptions options{.lower = Vector3d::Constant(-1), .upper = Vector3d::Constant(1), .joint_steps = 2};
  options.approach_steps = 2;
  const auto end_with = [&](double share, VectorXd& x) {
    return minimise_bias_free(
        [&](int, const VectorXd& at, double) {
          return BiasFreeTerms{.gradient = curvatures.cwiseProduct(at - truth) + share * more,
                               .hessian = curvatures.asDiagonal(),
                               .variance = 0.01};
        },
        options, x);
  };
  VectorXd one = Vector3d{0.25, 0.45, -0.95}, other = one;
  const BiasFreeEnd end = end_with(0, one);
  end_with(1, other);
  EXPECT_TRUE((one - other).isApprox(end.gain * more, 1e-6)) << one - other << "\n" << end.gain * more;
  EXPECT_LT(end.gain(1, 1), 10);  // 20 without damping
  EXPECT_EQ(end.gain.row(2), Eigen::RowVector3d::Zero());
}

TEST(BiasFreeTest, NoStepIsLongerThanAllowed) {
  NoisyProblem problem(9);
  const BiasFreeOptions options = wide();
  VectorXd x = NoisyProblem::truth() + Vector3d(1.5, 0, 0), last = x;
  const BiasFreeEnd end = minimise_bias_free(
      [&](int step, const VectorXd& at, double old) {
        EXPECT_LE((at - last).cwiseAbs().maxCoeff(), options.longest + 1e-12) << step;
        last = at;
        return problem.terms_at(at, old);
      },
      options, x);
  EXPECT_EQ(end.losses.size(), static_cast<std::size_t>(options.approach_steps + options.joint_steps));
  EXPECT_LT(end.losses.back(), end.losses.front());
}

}  // namespace
}  // namespace inversion

// Straight problems whose residuals and Jacobians are both noisy, as estimated pictures are.
#include "inversion/solve/bias_free.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cstdio>
#include <random>

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
  BiasFreeTerms terms_at(const VectorXd& x) {
    const MatrixXd by_a = jacobian_ + noise(kJacobianNoise), by_b = jacobian_ + noise(kJacobianNoise);
    const VectorXd a = by_a * (x - truth()) + noise(kNoise).col(0), b = by_b * (x - truth()) + noise(kNoise).col(0);
    const MatrixXd product = by_a.transpose() * by_b;
    return {.loss = 0.5 * a.dot(b),
            .gradient = 0.5 * (by_a.transpose() * b + by_b.transpose() * a),
            .hessian = 0.5 * (product + product.transpose())};
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
    minimise_bias_free([&](int, const VectorXd& at) { return problem.terms_at(at); }, options, x);
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
  minimise_bias_free([&](int, const VectorXd& at) { return problem.terms_at(at); }, options, x);
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
  minimise_bias_free([&](int, const VectorXd& at) { return problem.terms_at(at); }, options, x);
  EXPECT_NEAR(x[1], kWall, 0.06);
}

TEST(BiasFreeTest, WhatIsLeftOfTheStartIsWhatAnotherStartChanges) {
  const Vector3d curvatures{1, 0.05, 2}, truth{0.3, 0.5, -1.4};  // the second is hardly told, the third ends at a bound
  const auto terms_at = [&](int, const VectorXd& at) {
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

TEST(BiasFreeTest, NoStepIsLongerThanAllowed) {
  NoisyProblem problem(9);
  const BiasFreeOptions options = wide();
  VectorXd x = NoisyProblem::truth() + Vector3d(1.5, 0, 0), last = x;
  const BiasFreeEnd end = minimise_bias_free(
      [&](int step, const VectorXd& at) {
        EXPECT_LE((at - last).cwiseAbs().maxCoeff(), options.longest + 1e-12) << step;
        last = at;
        return problem.terms_at(at);
      },
      options, x);
  EXPECT_EQ(end.losses.size(), static_cast<std::size_t>(options.approach_steps + options.joint_steps));
  EXPECT_LT(end.losses.back(), end.losses.front());
}

}  // namespace
}  // namespace inversion

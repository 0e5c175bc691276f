#include "inversion/fit/loss_terms.h"

#include <ceres/ceres.h>
#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <random>
#include <vector>

namespace inversion {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kWeight = 0.3;
constexpr int kCount = renderer::kThreadParameterCount;

// Drawn from the prior's Gaussian, `unlike` times as far from its mean.
VectorXd drawn(std::mt19937& random, double unlike) {
  std::normal_distribution<double> normal;
  const renderer::ThreadPrior& prior = renderer::simulated_thread_prior();
  const renderer::PriorVector z = renderer::PriorVector::NullaryExpr([&] { return normal(random); });
  VectorXd unknowns = VectorXd::Constant(kCount, 0.3);
  unknowns.tail<renderer::kPriorUnknownCount>() =
      prior.mean + unlike * renderer::PriorMatrix(prior.covariance.llt().matrixL()) * z;
  return unknowns;
}

class ThreadPriorTermTest : public testing::TestWithParam<double> {
 protected:
  ThreadPriorTermTest() : random_(5), unknowns_(drawn(random_, GetParam())) {}
  VectorXd gradient_by_differences(const VectorXd& at) const {
    constexpr double kStep = 1e-5;
    VectorXd gradient(kCount);
    for (int k = 0; k < kCount; ++k) {
      const VectorXd step = kStep * VectorXd::Unit(kCount, k);
      gradient[k] = (term_.loss(at + step) - term_.loss(at - step)) / (2 * kStep);
    }
    return gradient;
  }

  ThreadPriorTerm term_{kWeight};
  std::mt19937 random_;
  VectorXd unknowns_;
};

TEST_P(ThreadPriorTermTest, GradientIsTheSlopeOfTheLoss) {
  const VectorXd gradient = term_.at(unknowns_).gradient, expected = gradient_by_differences(unknowns_);
  EXPECT_LE((gradient - expected).norm(), 1e-5 * expected.norm());
}

TEST_P(ThreadPriorTermTest, ItsQuadraticIsNowhereBelowIt) {
  const BiasFreeTerms here = term_.at(unknowns_);
  for (int i = 0; i < 300; ++i) {
    const VectorXd there = drawn(random_, 0.01 * i), step = there - unknowns_;
    const double quadratic = here.loss + here.gradient.dot(step) + 0.5 * step.dot(here.hessian * step);
    EXPECT_GE(quadratic, term_.loss(there) * (1 - 1e-9)) << i;
  }
}

TEST_P(ThreadPriorTermTest, ItTellsAsMuchAsItsHessianWhereThatIsPositive) {
  constexpr double kStep = 1e-4;
  MatrixXd hessian(kCount, kCount);
  for (int k = 0; k < kCount; ++k) {
    const VectorXd step = kStep * VectorXd::Unit(kCount, k);
    hessian.col(k) = (term_.at(unknowns_ + step).gradient - term_.at(unknowns_ - step).gradient) / (2 * kStep);
  }
  // In z, where the Hessian is diagonal.
  const renderer::PriorMatrix root = renderer::simulated_thread_prior().covariance.llt().matrixL();
  const auto in_z = [&](const MatrixXd& of_all) {
    return MatrixXd(root.transpose() *
                    of_all.bottomRightCorner<renderer::kPriorUnknownCount, renderer::kPriorUnknownCount>() * root);
  };
  const Eigen::SelfAdjointEigenSolver<MatrixXd> axes(in_z(0.5 * (hessian + hessian.transpose())));
  const MatrixXd positive =
      axes.eigenvectors() * axes.eigenvalues().cwiseMax(0).asDiagonal() * axes.eigenvectors().transpose();
  const auto rows = term_.known_rows(unknowns_);
  EXPECT_LE((in_z(rows.transpose() * rows) - positive).norm(), 1e-3 * positive.norm());
}

TEST_P(ThreadPriorTermTest, CeresSeesTheSameLoss) {
  ceres::Problem problem;
  term_.add_to(problem, unknowns_.data());
  double cost = 0;
  std::vector<double> gradient;
  problem.Evaluate({}, &cost, nullptr, &gradient, nullptr);
  EXPECT_NEAR(cost, term_.loss(unknowns_), 1e-9 * cost);
  const VectorXd expected = term_.at(unknowns_).gradient;
  EXPECT_LE((Eigen::Map<VectorXd>(gradient.data(), kCount) - expected).norm(), 1e-9 * expected.norm());
}

TEST(ThreadPriorTerm, HoldsAThreadThatIsUnusualInOneRespectInTheOthers) {
  const renderer::ThreadPrior& prior = renderer::simulated_thread_prior();
  const renderer::PriorMatrix root = prior.covariance.llt().matrixL();
  const ThreadPriorTerm term(kWeight);
  const auto pull_of_first = [&](double last) {
    renderer::PriorVector z = renderer::PriorVector::Zero();
    z[0] = 0.5, z[renderer::kPriorUnknownCount - 1] = last;
    VectorXd unknowns = VectorXd::Constant(kCount, 0.3);
    unknowns.tail<renderer::kPriorUnknownCount>() = prior.mean + root * z;
    const VectorXd gradient = term.at(unknowns).gradient;
    return (root.transpose() * gradient.tail<renderer::kPriorUnknownCount>())[0];
  };
  EXPECT_NEAR(pull_of_first(8), pull_of_first(0), 1e-9);
  EXPECT_GT(pull_of_first(0), 0.4 * kWeight);
}

INSTANTIATE_TEST_SUITE_P(Like, ThreadPriorTermTest, testing::Values(0.1, 0.5, 1.0, 3.0));

TEST(ThreadPriorTerm, DrawsAThreadUnlikeTheSimulatedOnesLessThanTheirGaussianWould) {
  std::mt19937 random(3);
  const ThreadPriorTerm term(kWeight);
  const auto pull = [&](double unlike) {
    std::mt19937 same(3);
    return term.at(drawn(same, unlike)).gradient.norm();
  };
  EXPECT_LT(pull(4), 1.5 * pull(1));              // a Gaussian's is four times as strong
  EXPECT_NEAR(pull(0.02) / pull(0.01), 2, 0.01);  // near the mean it is the Gaussian
}

TEST(EnergyLimits, CostWhatThePenaltyCosts) {
  VectorXd unknowns = unknowns_of(starting_thread());
  unknowns[kL0] = 0.2, unknowns[kL1] = 0.1, unknowns[kR1a] = 0.9, unknowns[kN2] = 0.2;  // beyond 1 at steep angles
  const EnergyLimits limits = energy_limits(ThreadFamily{}, unknowns);
  EXPECT_GT(limits.excess.maxCoeff(), 0);
  EXPECT_LT(limits.excess.minCoeff(), 0);
  const BiasFreeTerms with = OtherTerms(ThreadFamily{}, 0).at(unknowns),
                      without = OtherTerms(ThreadFamily{}, 0, false).at(unknowns);
  const VectorXd beyond = limits.excess.cwiseMax(0);
  EXPECT_NEAR(with.loss - without.loss, 0.5 * beyond.squaredNorm(), 1e-12);
  const VectorXd gradient = limits.rows.transpose() * beyond;
  EXPECT_LE((with.gradient - without.gradient - gradient).norm(), 1e-9 * gradient.norm());
  EXPECT_EQ(energy_limits(FiberFamily{}, VectorXd::Zero(5)).excess.size(), 0);
}

}  // namespace
}  // namespace inversion

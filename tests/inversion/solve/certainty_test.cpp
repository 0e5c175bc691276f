#include "inversion/solve/certainty.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <random>

namespace inversion {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

// Rows RGB by block, two views.
LinearisedFit random_fit(int unknowns, double sigma) {
  std::mt19937 random(7);
  std::normal_distribution<double> normal;
  LinearisedFit fit;
  constexpr int kRows = 240;
  fit.jacobian = MatrixXd::NullaryExpr(kRows, unknowns, [&] { return normal(random); });
  fit.residuals = VectorXd::NullaryExpr(kRows, [&] { return sigma * normal(random); });
  fit.variances = VectorXd::Constant(kRows, sigma * sigma);
  for (int row = 0; row < kRows; ++row) fit.views.push_back(row < kRows / 2 ? 0 : 1);
  fit.fixed.assign(static_cast<std::size_t>(unknowns), false);
  fit.scales = VectorXd::Ones(unknowns);
  return fit;
}

TEST(CertaintyTest, IsTheTextbooksCovarianceWhereTheWeightsAreRight) {
  const LinearisedFit fit = random_fit(4, 0.1);
  const Certainty certainty = certainty_of(fit);
  const MatrixXd expected = 0.01 * (fit.jacobian.transpose() * fit.jacobian).inverse();
  EXPECT_TRUE(certainty.noise_covariance.isApprox(expected, 1e-9));
  EXPECT_NEAR(certainty.misfit, 1, 0.1);  // 240 residuals
}

TEST(CertaintyTest, NoiseThatTheWeightsIgnoreIsThatOfTheEstimate) {
  LinearisedFit fit = random_fit(3, 0.1);
  fit.variances.head(60).setConstant(4);
  const Certainty certainty = certainty_of(fit);
  const MatrixXd solve = (fit.jacobian.transpose() * fit.jacobian).inverse() * fit.jacobian.transpose();
  EXPECT_TRUE(certainty.noise_covariance.isApprox(solve * fit.variances.asDiagonal() * solve.transpose(), 1e-9));
}

// Three residuals of a block that err together are one piece of information.
TEST(CertaintyTest, NoiseThatColoursShareIsCountedOnce) {
  LinearisedFit fit = random_fit(3, 0.1);
  for (Eigen::Index row = 0; row < fit.jacobian.rows(); row += 3)
    fit.jacobian.row(row + 1) = fit.jacobian.row(row + 2) = fit.jacobian.row(row);
  const MatrixXd apart = certainty_of(fit).noise_covariance;
  MatrixXd together = MatrixXd::Zero(3, 3);
  for (Eigen::Index row = 0; row < fit.jacobian.rows(); row += 3) {
    const VectorXd summed = 3 * fit.jacobian.row(row).transpose();
    together += fit.variances[row] * summed * summed.transpose();
  }
  fit.gradient_covariance = together;
  EXPECT_TRUE(certainty_of(fit).noise_covariance.isApprox(3 * apart, 1e-9));
}

TEST(CertaintyTest, MisfitCommonToAViewAddsToTheTotalOnly) {
  LinearisedFit fit = random_fit(3, 0.1);
  const Certainty before = certainty_of(fit);
  fit.residuals.head(120).array() += 1;
  const Certainty after = certainty_of(fit);
  EXPECT_TRUE(after.noise_covariance.isApprox(before.noise_covariance));
  EXPECT_GT(after.covariance.trace(), 5 * after.noise_covariance.trace());
  EXPECT_GT(after.misfit, 5);
}

TEST(CertaintyTest, FixedUnknownsHaveNoVarianceAndDoNotWidenTheOthers) {
  LinearisedFit fit = random_fit(3, 0.1);
  fit.fixed[1] = true;
  const Certainty certainty = certainty_of(fit);
  EXPECT_EQ(certainty.covariance.row(1).norm(), 0);
  MatrixXd two(fit.jacobian.rows(), 2);
  two << fit.jacobian.col(0), fit.jacobian.col(2);
  EXPECT_NEAR(certainty.noise_covariance(2, 2), 0.01 * (two.transpose() * two).inverse()(1, 1), 1e-12);
}

TEST(CertaintyTest, TheWorstDirectionIsTheOneThatNothingShows) {
  LinearisedFit fit = random_fit(3, 0.1);
  fit.jacobian.col(2) = fit.jacobian.col(0) * (1 + 1e-4);  // only their sum is seen
  const Certainty certainty = certainty_of(fit);
  const VectorXd& worst = certainty.weakest.front().direction;
  EXPECT_NEAR(std::abs(worst.dot(Eigen::Vector3d(1, 0, -1).normalized())), 1, 1e-3);
  EXPECT_GT(certainty.weakest.front().sigma, 100 * certainty.weakest.back().sigma);
}

}  // namespace
}  // namespace inversion

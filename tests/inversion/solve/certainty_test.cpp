#include "inversion/solve/certainty.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

namespace inversion {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

// Rows RGB by block.
LinearisedFit random_fit(int unknowns, double sigma) {
  std::mt19937 random(7);
  std::normal_distribution<double> normal;
  LinearisedFit fit;
  constexpr int kRows = 240;
  fit.jacobian = MatrixXd::NullaryExpr(kRows, unknowns, [&] { return normal(random); });
  fit.residuals = VectorXd::NullaryExpr(kRows, [&] { return sigma * normal(random); });
  fit.variances = VectorXd::Constant(kRows, sigma * sigma);
  fit.held.assign(static_cast<std::size_t>(unknowns), false);
  fit.bounds.assign(static_cast<std::size_t>(unknowns), 0);
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

// Damped steps from random starts towards the minima of many draws of the noise.
TEST(CertaintyTest, StepsThatDoNotReachTheMinimumSpreadByWhatTheyLeaveOfTheirStart) {
  constexpr int kDraws = 20000, kSteps = 3;
  constexpr double kStartDeviation = 0.05;
  const MatrixXd damping = Eigen::Vector3d(20, 5, 40).asDiagonal();
  LinearisedFit fit = random_fit(3, 0.1);
  fit.jacobian.col(2) *= 0.1;  // hardly told
  const MatrixXd hessian = fit.jacobian.transpose() * fit.jacobian, identity = MatrixXd::Identity(3, 3);
  const Certainty minimum = certainty_of(fit);
  const auto solver = MatrixXd(hessian + damping).ldlt();
  fit.left = identity, fit.gain = MatrixXd::Zero(3, 3);
  for (int step = 0; step < kSteps; ++step) {
    fit.left = solver.solve(MatrixXd(damping * fit.left));
    fit.gain = solver.solve(MatrixXd(damping * fit.gain + identity));
  }
  fit.start_covariance = kStartDeviation * kStartDeviation * identity;
  std::mt19937 random(3);
  std::normal_distribution<double> normal(0, 0.1), start(0, kStartDeviation);
  MatrixXd spread = MatrixXd::Zero(3, 3);
  for (int draw = 0; draw < kDraws; ++draw) {
    const VectorXd pull =
        fit.jacobian.transpose() * VectorXd::NullaryExpr(fit.jacobian.rows(), [&] { return normal(random); });
    VectorXd at = VectorXd::NullaryExpr(3, [&] { return start(random); });
    for (int step = 0; step < kSteps; ++step) at -= solver.solve(VectorXd(hessian * at - pull));
    spread += at * at.transpose() / kDraws;
  }
  const Certainty certainty = certainty_of(fit);
  EXPECT_TRUE(certainty.noise_covariance.isApprox(spread, 0.05)) << certainty.noise_covariance << "\n" << spread;
  EXPECT_LT(certainty.noise_covariance(2, 2), 0.8 * minimum.noise_covariance(2, 2));
  EXPECT_TRUE(certainty.covariance.isApprox(minimum.covariance)) << "of the minimum itself";
}

TEST(CertaintyTest, MisfitAddsWhatItMovesTheMinimumByToTheTotalOnly) {
  LinearisedFit fit = random_fit(3, 0.1);
  const Certainty before = certainty_of(fit);
  const VectorXd pull = 2 * fit.jacobian.topRows(120).colwise().sum();
  fit.misfit_covariance = pull * pull.transpose();
  const Certainty after = certainty_of(fit);
  const VectorXd moved = (fit.jacobian.transpose() * fit.jacobian).ldlt().solve(pull);
  EXPECT_TRUE(after.noise_covariance.isApprox(before.noise_covariance));
  const MatrixXd added = after.covariance - before.covariance;
  EXPECT_TRUE(added.isApprox(moved * moved.transpose(), 1e-3)) << added << "\n" << moved * moved.transpose();
}

TEST(CertaintyTest, HeldUnknownsHaveNoVarianceAndDoNotWidenTheOthers) {
  LinearisedFit fit = random_fit(3, 0.1);
  fit.held[1] = true;
  const Certainty certainty = certainty_of(fit);
  EXPECT_EQ(certainty.covariance.row(1).norm(), 0);
  MatrixXd two(fit.jacobian.rows(), 2);
  two << fit.jacobian.col(0), fit.jacobian.col(2);
  EXPECT_NEAR(certainty.noise_covariance(2, 2), 0.01 * (two.transpose() * two).inverse()(1, 1), 1e-12);
}

// Two unknowns that trade with each other.
LinearisedFit traded_fit() {
  LinearisedFit fit = random_fit(2, 0.1);
  fit.jacobian.col(1) += 2 * fit.jacobian.col(0);
  return fit;
}

// What the unknowns may be, when all that lie on this side of the bound are as likely beforehand: by summing their
// probability over a grid, about the best of them.
MatrixXd summed_covariance(const LinearisedFit& fit, const Eigen::Vector2d& unbounded, double bound, int side,
                           Eigen::Vector2d& best) {
  const MatrixXd square = fit.jacobian.transpose() * fit.jacobian / fit.variances[0];
  const auto misfit = [&](const Eigen::Vector2d& x) { return (x - unbounded).dot(square * (x - unbounded)); };
  constexpr int kSteps = 800;
  const double step = 0.0002;
  double least = std::numeric_limits<double>::max(), sum = 0;
  std::vector<Eigen::Vector2d> places;
  for (int i = 0; i < kSteps; ++i)
    for (int j = 0; j < 2 * kSteps; ++j)
      places.push_back({bound - side * step * (i + 0.5), unbounded.y() + step * (j - kSteps)});
  for (const Eigen::Vector2d& place : places)
    if (const double here = misfit({bound, place.y()}); here < least) least = here, best = {bound, place.y()};
  MatrixXd covariance = MatrixXd::Zero(2, 2);
  for (const Eigen::Vector2d& place : places) {
    const double likely = std::exp(-0.5 * (misfit(place) - least));
    sum += likely;
    covariance += likely * (place - best) * (place - best).transpose();
  }
  return covariance / sum;
}

TEST(CertaintyTest, AtABoundDeviationsAreOneSidedAndWhatTradesWithTheUnknownIsUncertainByThat) {
  LinearisedFit fit = traded_fit();
  fit.residuals.setZero();  // no misfit
  const MatrixXd square = fit.jacobian.transpose() * fit.jacobian;
  const Eigen::Vector2d unbounded(0.3, -0.2);
  const double deviation = std::sqrt(certainty_of(fit).covariance(0, 0));  // without a bound
  for (const int side : {-1, 1})
    for (const double beyond : {0.0, 0.01, 0.03}) {
      const double bound = unbounded.x() - side * beyond;
      Eigen::Vector2d best;
      const MatrixXd expected = summed_covariance(fit, unbounded, bound, side, best);
      fit.bounds[0] = side;
      fit.gradient = square * (best - unbounded);
      const Certainty certainty = certainty_of(fit);
      EXPECT_TRUE(certainty.at_bound[0]);
      EXPECT_FALSE(certainty.at_bound[1]);
      EXPECT_NEAR(certainty.beyond_bound[0], beyond / deviation, 0.01);
      EXPECT_EQ(certainty.beyond_bound[1], 0);
      EXPECT_TRUE(certainty.covariance.isApprox(expected, 0.02)) << "side " << side << ", " << beyond << " beyond:\n"
                                                                 << certainty.covariance << "\nby summing:\n"
                                                                 << expected;
    }
  // A minimum twenty deviations beyond says that they are too small, not that the unknown is known to a tenth of one.
  fit.gradient = 30 * square * Eigen::Vector2d(-0.01, 0);
  const double far = certainty_of(fit).covariance(0, 0);
  // Without a gradient it is as if the minimum lay on the bound.
  fit.gradient = VectorXd();
  const double level = certainty_of(fit).covariance(0, 0);
  fit.bounds[0] = 0;
  EXPECT_NEAR(level / certainty_of(fit).covariance(0, 0), 1, 1e-9);
  EXPECT_NEAR(std::sqrt(far / level), 0.38, 0.02);  // that of three deviations
}

TEST(CertaintyTest, AtABoundTheSpreadIsThatOfFitsWithOtherNoise) {
  LinearisedFit fit = traded_fit();
  const double sigma = 0.1;
  const MatrixXd square = fit.jacobian.transpose() * fit.jacobian;
  const MatrixXd root = (sigma * sigma * square.inverse()).llt().matrixL();
  std::mt19937 random(11);
  std::normal_distribution<double> normal;
  const Eigen::Vector2d minimum(0.3, -0.2);  // of pictures without noise, at the bound
  const double bound = minimum.x();
  // Of the unknown that trades with the first one, where that stays at the bound.
  const auto at_bound = [&](const Eigen::Vector2d& unbounded) {
    const double moved = square(1, 0) / square(1, 1) * (unbounded.x() - bound);
    return Eigen::Vector2d(bound, unbounded.y() + moved);
  };
  constexpr int kDraws = 200000;
  Eigen::Vector2d sum(0, 0);
  Eigen::Matrix2d squares = Eigen::Matrix2d::Zero();
  for (int i = 0; i < kDraws; ++i) {
    const Eigen::Vector2d drawn = minimum + root * Eigen::Vector2d(normal(random), normal(random));
    const Eigen::Vector2d off = (drawn.x() > bound ? at_bound(drawn) : drawn) - minimum;
    sum += off;
    squares += off * off.transpose();
  }
  const Eigen::Matrix2d expected = squares / kDraws - sum * sum.transpose() / kDraws / kDraws;
  fit.bounds[0] = 1;
  for (const double beyond : {0.0, 0.005, 0.01}) {  // whichever of these draws this fit is
    const Eigen::Vector2d drawn = minimum + Eigen::Vector2d(beyond, 0);
    fit.gradient = square * (at_bound(drawn) - drawn);
    const Certainty certainty = certainty_of(fit);
    EXPECT_TRUE(certainty.noise_covariance.isApprox(expected, 0.02)) << beyond << " beyond:\n"
                                                                     << certainty.noise_covariance << "\nby drawing:\n"
                                                                     << expected;
    for (int k = 0; k < 2; ++k)
      EXPECT_NEAR(certainty.noise_covariance(k, k) / expected(k, k), 1, 0.03) << beyond << ", unknown " << k;
  }
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

// A linear problem whose estimate from several sets of paths is found many times over: its spread is the oracle.
#include "inversion/solve/joined_sets.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <array>
#include <cmath>
#include <cstdio>
#include <random>
#include <vector>

#include "inversion/fit/block_covariance.h"

namespace inversion {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr int kBlocks = 200, kRows = 3 * kBlocks, kUnknowns = 4, kSets = 8;

struct Halves {
  std::array<VectorXd, 2> residuals;
  std::array<MatrixXd, 2> jacobians;
};

struct Problem {
  VectorXd truth;
  MatrixXd jacobian;
  double photographs;         // deviations of a residual
  double paths;               // those of a half of the paths, alike in the three colours of a block
  double jacobian_noise = 0;  // of an entry of a half's Jacobian
  std::mt19937 random;

  Problem(double photographs_in, double paths_in, std::uint32_t seed)
      : photographs(photographs_in), paths(paths_in), random(seed) {
    truth = normal(kUnknowns, 1, 1);
    jacobian = normal(kRows, kUnknowns, 1);
  }
  MatrixXd normal(Eigen::Index rows, Eigen::Index columns, double deviation) {
    std::normal_distribution<double> numbers(0, deviation);
    return MatrixXd::NullaryExpr(rows, columns, [&] { return deviation > 0 ? numbers(random) : 0; });
  }
  Halves set(const VectorXd& at, const VectorXd& photograph_noise) {
    Halves both;
    for (std::size_t h = 0; h < 2; ++h) {
      both.jacobians[h] = jacobian + normal(kRows, kUnknowns, jacobian_noise);
      both.residuals[h] = both.jacobians[h] * (at - truth) - photograph_noise;
      const VectorXd of_blocks = normal(kBlocks, 1, paths);
      for (int row = 0; row < kRows; ++row) both.residuals[h][row] += of_blocks[row / 3];
    }
    return both;
  }
  JoinedSets sets(int count) {
    const VectorXd noise = normal(kRows, 1, photographs);
    JoinedSets sets;
    for (int k = 0; k < count; ++k) {
      const VectorXd at = truth + normal(kUnknowns, 1, 0.5);
      const Halves both = set(at, noise);
      sets.add(both.residuals, both.jacobians, at);
    }
    return sets;
  }
};

VectorXd minimum_of(const JoinedSets& sets) {
  return -sets.hessian().ldlt().solve(sets.at(VectorXd::Zero(kUnknowns)).gradient);
}

// Predicted over observed deviations of each unknown.
VectorXd ratios(Problem& problem) {
  constexpr int kDraws = 400;
  VectorXd observed = VectorXd::Zero(kUnknowns), predicted = observed;
  for (int draw = 0; draw < kDraws; ++draw) {
    const JoinedSets sets = problem.sets(kSets);
    const VectorXd found = minimum_of(sets);
    observed += (found - problem.truth).cwiseAbs2();
    const MatrixXd inverse = sets.hessian().inverse();
    predicted += (inverse * block_covariance(sets.gradients(found)) * inverse).diagonal();
  }
  return (predicted.array() / observed.array()).sqrt();
}

void expect_all_near_one(const VectorXd& ratios) {
  EXPECT_GT(ratios.minCoeff(), 0.85) << ratios.transpose();
  EXPECT_LT(ratios.maxCoeff(), 1.15) << ratios.transpose();
}

TEST(JoinedSetsTest, TheNoiseOfPathsAveragesOutInTheMeanOfTheirSets) {
  Problem problem(0, 0.3, 1);
  expect_all_near_one(ratios(problem));
}

TEST(JoinedSetsTest, TheNoiseOfPhotographsDoesNot) {
  Problem problem(0.3, 0.01, 2);
  expect_all_near_one(ratios(problem));
}

TEST(JoinedSetsTest, TheNoiseOfJacobiansIsInTheSpread) {
  Problem problem(0.02, 0.3, 3);
  problem.jacobian.col(1) = 3 * problem.jacobian.col(0) + 0.05 * problem.jacobian.col(1);  // they trade off
  problem.jacobian_noise = 0.1;
  expect_all_near_one(ratios(problem));
}

TEST(JoinedSetsTest, OneSetIsTheProductOfItsHalves) {
  Problem problem(0.1, 0.3, 4);
  problem.jacobian_noise = 0.2;
  const VectorXd at = problem.normal(kUnknowns, 1, 1), x = problem.normal(kUnknowns, 1, 1);
  const auto [residuals, jacobians] = problem.set(at, problem.normal(kRows, 1, 0.1));
  JoinedSets sets;
  sets.add(residuals, jacobians, at);
  const VectorXd a = residuals[0] + jacobians[0] * (x - at), b = residuals[1] + jacobians[1] * (x - at);
  const MatrixXd product = jacobians[0].transpose() * jacobians[1];
  const BiasFreeTerms terms = sets.at(x);
  EXPECT_NEAR(terms.loss, a.dot(b) / 2, 1e-9 * std::abs(a.dot(b)));
  EXPECT_TRUE(terms.gradient.isApprox((jacobians[0].transpose() * b + jacobians[1].transpose() * a) / 2, 1e-9));
  EXPECT_TRUE(terms.hessian.isApprox((product + product.transpose()) / 2, 1e-9));
}

// Two unknowns make up for each other, so that all that J v holds along them is noise.
TEST(JoinedSetsTest, MisfitOfAGroupPullsAsItsRowsDoTogetherAndTheirNoiseDoesNot) {
  constexpr int kDraws = 200, kGroup = kRows / 2;
  constexpr double kMisfit = 0.5;
  Problem problem(0, 0.3, 7);
  problem.jacobian.col(1) = problem.jacobian.col(0);
  problem.jacobian_noise = 0.2;
  VectorXd misfit = VectorXd::Zero(kRows), direction = VectorXd::Zero(kUnknowns);
  misfit.head(kGroup).setConstant(kMisfit);
  direction.head<2>() << std::sqrt(0.5), -std::sqrt(0.5);
  std::vector<int> groups(kRows);
  for (int row = 0; row < kRows; ++row) groups[static_cast<std::size_t>(row)] = row < kGroup ? 0 : 1;
  MatrixXd mean = MatrixXd::Zero(kUnknowns, kUnknowns);
  for (int draw = 0; draw < kDraws; ++draw) {
    JoinedSets sets;
    for (int k = 0; k < kSets; ++k) {
      const Halves both = problem.set(problem.truth, misfit);
      sets.add(both.residuals, both.jacobians, problem.truth);
    }
    mean += sets.misfit_covariance(problem.truth, groups, VectorXd::Zero(kRows)) / kDraws;
  }
  const VectorXd pull = kMisfit * problem.jacobian.topRows(kGroup).colwise().sum();
  EXPECT_TRUE(mean.isApprox(pull * pull.transpose(), 0.05)) << mean << "\n" << pull * pull.transpose();
  const double of_noise = kMisfit * kMisfit * kGroup * problem.jacobian_noise * problem.jacobian_noise / (2 * kSets);
  EXPECT_NEAR(direction.dot(mean * direction), 0, 0.2 * of_noise);
}

// The loss without noise, whatever the sets count.
TEST(JoinedSetsTest, AreWithoutBias) {
  constexpr int kDraws = 2000;
  constexpr double kOld = 0.7;
  Problem problem(0, 0.3, 6);
  problem.jacobian_noise = 0.2;
  const VectorXd none = VectorXd::Zero(kRows), x = problem.truth + problem.normal(kUnknowns, 1, 0.05);
  double sum = 0, squares = 0;
  for (int draw = 0; draw < kDraws; ++draw) {
    JoinedSets sets;
    for (int k = 0; k < 3; ++k) {
      const VectorXd at = problem.truth + problem.normal(kUnknowns, 1, 0.5);
      const Halves both = problem.set(at, none);
      sets.add(both.residuals, both.jacobians, at, kOld);
    }
    const double loss = sets.at(x).loss;
    sum += loss / kDraws, squares += loss * loss / kDraws;
  }
  const double expected = (problem.jacobian * (x - problem.truth)).squaredNorm() / 2,
               deviation = std::sqrt((squares - sum * sum) / kDraws);
  std::printf("%.4f +- %.4f for %.4f\n", sum, deviation, expected);
  EXPECT_NEAR(sum, expected, 4 * deviation);
  EXPECT_LT(deviation, 0.05 * expected);
}

// Where Jacobians change from place to place, that is no noise: the mean's square is all there is.
TEST(JoinedSetsTest, PlacesThatDisagreeAreNotTakenForNoise) {
  Problem problem(0, 0, 7);
  const VectorXd x = problem.normal(kUnknowns, 1, 1);
  JoinedSets sets;
  VectorXd mean = VectorXd::Zero(kRows);
  MatrixXd mean_jacobian = MatrixXd::Zero(kRows, kUnknowns);
  for (int k = 0; k < 2; ++k) {
    const MatrixXd jacobian = problem.normal(kRows, kUnknowns, 1);
    const VectorXd residuals = problem.normal(kRows, 1, 1), at = problem.normal(kUnknowns, 1, 1);
    sets.add({residuals, residuals}, {jacobian, jacobian}, at, 0.5);
    const double weight = k == 0 ? 1 / 3.0 : 2 / 3.0;
    mean += weight * (residuals + jacobian * (x - at));
    mean_jacobian += weight * jacobian;
  }
  EXPECT_NEAR(sets.at(x).loss, mean.squaredNorm() / 2, 1e-9 * mean.squaredNorm());
  EXPECT_TRUE(sets.at(x).gradient.isApprox(mean_jacobian.transpose() * mean, 1e-9));
  EXPECT_TRUE(sets.hessian().isApprox(mean_jacobian.transpose() * mean_jacobian, 1e-9));
  EXPECT_NEAR(sets.variance_of_mean(), 5 / 9.0, 1e-12);
}

// Along a direction v of which pictures say nothing, v' H v is the noise of J alone.
TEST(JoinedSetsTest, TheNoiseOfJacobiansFallsWithTheNumberOfSets) {
  constexpr int kDraws = 200;
  Problem problem(0, 0, 5);
  problem.jacobian.col(0).setZero();
  problem.jacobian_noise = 1;
  const auto spread_of = [&](int count) {
    double squares = 0;
    for (int draw = 0; draw < kDraws; ++draw) squares += std::pow(problem.sets(count).hessian()(0, 0), 2);
    return std::sqrt(squares / kDraws);
  };
  const double one = spread_of(1), eight = spread_of(8);
  std::printf("noise of the Hessian by 8 sets over that by 1: %.3f\n", eight / one);
  EXPECT_LT(eight, 1.2 * one / 8);
}

TEST(JoinedSetsTest, CurvaturesSpreadAsTheySay) {
  constexpr int kDraws = 400;
  Problem problem(0, 0, 8);
  problem.jacobian.col(0) *= 0.1;  // hardly told
  problem.jacobian_noise = 0.3;
  for (int k : {0, 1}) {
    const VectorXd direction = VectorXd::Unit(kUnknowns, k);
    double sum = 0, squares = 0, predicted = 0;
    for (int draw = 0; draw < kDraws; ++draw) {
      const JoinedSets sets = problem.sets(4);
      const double curvature = direction.dot(sets.hessian() * direction);
      sum += curvature / kDraws, squares += curvature * curvature / kDraws;
      predicted += std::pow(sets.curvature_deviation(direction), 2) / kDraws;
    }
    EXPECT_NEAR(std::sqrt(predicted / (squares - sum * sum)), 1, 0.25) << k;
  }
}

}  // namespace
}  // namespace inversion

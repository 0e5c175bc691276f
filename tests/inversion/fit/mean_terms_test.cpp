// A linear problem whose estimate from several sets of paths is found many times over: its spread is the oracle.
#include "inversion/fit/mean_terms.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <random>

namespace inversion {
namespace {

using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;

constexpr int kBlocks = 200, kRows = 3 * kBlocks, kUnknowns = 4, kSets = 8;

VectorXd normal_numbers(int count, double deviation, std::mt19937& random) {
  std::normal_distribution<double> normal(0, deviation);
  VectorXd numbers(count);
  for (double& number : numbers) number = normal(random);
  return numbers;
}

struct Problem {
  VectorXd truth;
  MatrixXd jacobian;
  double photographs;  // deviations of a residual
  double paths;        // those of a half of the paths, alike in the three colours of a block
  std::mt19937 random;

  Problem(double photographs_in, double paths_in, std::uint32_t seed)
      : photographs(photographs_in), paths(paths_in), random(seed) {
    truth = normal_numbers(kUnknowns, 1, random);
    jacobian = normal_numbers(kRows * kUnknowns, 1, random).reshaped(kRows, kUnknowns);
  }
  ViewObjective::Halves set(const VectorXd& at, const VectorXd& photograph_noise) {
    ViewObjective::Halves both;
    for (VectorXd& residuals : both.residuals) {
      residuals = jacobian * (at - truth) - photograph_noise;
      const VectorXd of_blocks = normal_numbers(kBlocks, paths, random);
      for (int row = 0; row < kRows; ++row) residuals[row] += of_blocks[row / 3];
    }
    for (MatrixXd& rows : both.jacobians) rows = jacobian;
    return both;
  }
  MeanTerms mean_of_sets() {
    const VectorXd noise = normal_numbers(kRows, photographs, random);
    MeanTerms mean;
    for (int k = 0; k < kSets; ++k) {
      const VectorXd at = truth + normal_numbers(kUnknowns, 0.5, random);
      mean.add(set(at, noise), at);
    }
    return mean;
  }
};

VectorXd minimum_of(const MeanTerms& mean) {
  return -mean.hessian().ldlt().solve(mean.gradient(VectorXd::Zero(kUnknowns)));
}

// Predicted over observed deviations of each unknown.
VectorXd ratios(Problem& problem) {
  constexpr int kDraws = 400;
  VectorXd observed = VectorXd::Zero(kUnknowns), predicted = observed;
  for (int draw = 0; draw < kDraws; ++draw) {
    const MeanTerms mean = problem.mean_of_sets();
    const VectorXd found = minimum_of(mean);
    observed += (found - problem.truth).cwiseAbs2();
    const MatrixXd inverse = mean.hessian().inverse();
    predicted += (inverse * mean.gradient_covariance(found) * inverse).diagonal();
  }
  return (predicted.array() / observed.array()).sqrt();
}

TEST(MeanTermsTest, TheNoiseOfPathsAveragesOutInTheMeanOfTheirSets) {
  Problem problem(0, 0.3, 1);
  const VectorXd found = ratios(problem);
  EXPECT_GT(found.minCoeff(), 0.85) << found.transpose();
  EXPECT_LT(found.maxCoeff(), 1.15) << found.transpose();
}

TEST(MeanTermsTest, TheNoiseOfPhotographsDoesNot) {
  Problem problem(0.3, 0.01, 2);
  const VectorXd found = ratios(problem);
  EXPECT_GT(found.minCoeff(), 0.85) << found.transpose();
  EXPECT_LT(found.maxCoeff(), 1.15) << found.transpose();
}

TEST(MeanTermsTest, SetsBeforeCountLessWhenTheyAreOld) {
  Problem problem(0, 0, 3);
  const VectorXd there = problem.truth + Vector3d::Ones().homogeneous(), none = VectorXd::Zero(kRows);
  MeanTerms mean;
  const ViewObjective::Halves far = problem.set(there, none);
  ViewObjective::Halves half = far;
  scale_rows(half, VectorXd::Constant(kRows, 0.5));
  mean.add(far, there);
  mean.add(half, there, 0.5);
  // (1 / 2 + 1 / 4) / (1 / 2 + 1) of the first one's.
  EXPECT_TRUE(mean.hessian().isApprox(0.5 * data_terms(far).hessian, 1e-12));
  EXPECT_TRUE(mean.gradient(there).isApprox(0.5 * data_terms(far).gradient, 1e-9));
  EXPECT_TRUE(minimum_of(mean).isApprox(problem.truth, 1e-9));
}

}  // namespace
}  // namespace inversion

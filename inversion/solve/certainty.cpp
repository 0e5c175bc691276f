#include "inversion/solve/certainty.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

namespace inversion {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

// Residuals are stored RGB, so that every third row has the same colour.
constexpr int kColours = 3;

// The part that the misfit of views adds to J' S J: each colour of a view errs as a whole.
MatrixXd misfit_part(const LinearisedFit& fit, const MatrixXd& jacobian) {
  const int views = 1 + *std::max_element(fit.views.begin(), fit.views.end());
  const Eigen::Index unknowns = jacobian.cols();
  MatrixXd sums = MatrixXd::Zero(views * kColours, unknowns);
  VectorXd excess = VectorXd::Zero(views * kColours), counts = excess;
  for (Eigen::Index row = 0; row < jacobian.rows(); ++row) {
    const Eigen::Index group = fit.views[static_cast<std::size_t>(row)] * kColours + row % kColours;
    sums.row(group) += jacobian.row(row);
    excess[group] += fit.residuals[row] * fit.residuals[row] - fit.variances[row];
    counts[group] += 1;
  }
  MatrixXd part = MatrixXd::Zero(unknowns, unknowns);
  for (Eigen::Index group = 0; group < sums.rows(); ++group)
    if (counts[group] > 0)
      part += std::max(0.0, excess[group] / counts[group]) * sums.row(group).transpose() * sums.row(group);
  return part;
}

MatrixXd columns(const MatrixXd& matrix, const std::vector<int>& chosen) {
  MatrixXd kept(matrix.rows(), static_cast<Eigen::Index>(chosen.size()));
  for (std::size_t k = 0; k < chosen.size(); ++k) kept.col(static_cast<Eigen::Index>(k)) = matrix.col(chosen[k]);
  return kept;
}

MatrixXd spread(const MatrixXd& matrix, const std::vector<int>& chosen, Eigen::Index size) {
  MatrixXd whole = MatrixXd::Zero(size, size);
  for (std::size_t i = 0; i < chosen.size(); ++i)
    for (std::size_t j = 0; j < chosen.size(); ++j)
      whole(chosen[i], chosen[j]) = matrix(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j));
  return whole;
}

// A symmetric matrix of all unknowns in the scaled free ones.
MatrixXd in_free(const LinearisedFit& fit, const MatrixXd& matrix, const std::vector<int>& free) {
  const MatrixXd scaled = fit.scales.asDiagonal() * matrix * fit.scales.asDiagonal();
  return columns(columns(scaled, free).transpose(), free);
}

// The data's Hessian in the scaled free unknowns. Noise may have made it indefinite; then it is J' J, which makes the
// fit look too certain.
MatrixXd data_hessian(const LinearisedFit& fit, const MatrixXd& jacobian, const std::vector<int>& free) {
  const MatrixXd square = jacobian.transpose() * jacobian;
  if (fit.hessian.size() == 0) return square;
  const MatrixXd kept = in_free(fit, fit.hessian, free);
  return Eigen::SelfAdjointEigenSolver<MatrixXd>(kept).eigenvalues().minCoeff() > 0 ? kept : square;
}

}  // namespace

Certainty certainty_of(const LinearisedFit& fit) {
  const Eigen::Index unknowns = fit.jacobian.cols();
  Certainty certainty{.noise_covariance = MatrixXd::Zero(unknowns, unknowns),
                      .covariance = MatrixXd::Zero(unknowns, unknowns),
                      .at_bound = fit.fixed};
  certainty.misfit = std::sqrt(fit.residuals.squaredNorm() /
                               std::max(fit.variances.sum(), 1e-12 * fit.residuals.squaredNorm() + 1e-300));
  std::vector<int> free;
  for (int k = 0; k < unknowns; ++k)
    if (!fit.fixed[static_cast<std::size_t>(k)]) free.push_back(k);
  if (free.empty()) return certainty;

  // All is in units of the scales, so that numbers of unlike size are inverted together.
  const VectorXd all_scales = fit.scales;
  const auto scaled = [&](const MatrixXd& rows) { return columns(rows * all_scales.asDiagonal(), free); };
  const MatrixXd jacobian = scaled(fit.jacobian);
  const MatrixXd identity = MatrixXd::Identity(jacobian.cols(), jacobian.cols());
  MatrixXd hessian = data_hessian(fit, jacobian, free), prior = MatrixXd::Zero(jacobian.cols(), jacobian.cols());
  for (const MatrixXd* rows : {&fit.penalty_jacobian, &fit.prior_jacobian})
    if (rows->rows() > 0) hessian += scaled(*rows).transpose() * scaled(*rows);
  if (fit.prior_jacobian.rows() > 0) prior = scaled(fit.prior_jacobian).transpose() * scaled(fit.prior_jacobian);
  const double mean_square = fit.residuals.squaredNorm() / static_cast<double>(fit.residuals.size());
  const double floor = 1e-12 * hessian.diagonal().maxCoeff();
  const MatrixXd noise = fit.gradient_covariance.size() > 0
                             ? in_free(fit, fit.gradient_covariance, free)
                             : MatrixXd(jacobian.transpose() * fit.variances.asDiagonal() * jacobian);
  const MatrixXd inverse = (hessian + floor * identity).ldlt().solve(identity);
  const MatrixXd by_noise = inverse * noise * inverse;
  // The deviation of 1 is one more piece of information on each unknown.
  const MatrixXd weak = (hessian + (mean_square + floor) * identity).ldlt().solve(identity);
  const MatrixXd total =
      weak * (noise + misfit_part(fit, jacobian) + mean_square * prior + mean_square * mean_square * identity) * weak;
  const auto unscaled = [&](const MatrixXd& c) {
    return MatrixXd(all_scales.asDiagonal() * spread(c, free, unknowns) * all_scales.asDiagonal());
  };
  certainty.noise_covariance = unscaled(by_noise);
  certainty.covariance = unscaled(total);
  const Eigen::SelfAdjointEigenSolver<MatrixXd> axes(0.5 * (total + total.transpose()));
  for (Eigen::Index k = axes.eigenvalues().size(); k-- > 0;) {
    VectorXd direction = VectorXd::Zero(unknowns);
    for (std::size_t i = 0; i < free.size(); ++i)
      direction[free[i]] = axes.eigenvectors()(static_cast<Eigen::Index>(i), k);
    certainty.weakest.push_back({direction, std::sqrt(std::max(0.0, axes.eigenvalues()[k]))});
  }
  return certainty;
}

}  // namespace inversion

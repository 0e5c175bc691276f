#include "inversion/solve/certainty.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace inversion {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

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

// A symmetric matrix of all unknowns in the scaled chosen ones.
MatrixXd in_chosen(const LinearisedFit& fit, const MatrixXd& matrix, const std::vector<int>& chosen) {
  const MatrixXd scaled = fit.scales.asDiagonal() * matrix * fit.scales.asDiagonal();
  return columns(columns(scaled, chosen).transpose(), chosen);
}

// The data's Hessian in the scaled chosen unknowns. Where noise has made it negative it counts as positive, as the
// steps take it (bias_free.h).
MatrixXd data_hessian(const LinearisedFit& fit, const MatrixXd& jacobian, const std::vector<int>& chosen) {
  if (fit.hessian.size() == 0) return jacobian.transpose() * jacobian;
  const Eigen::SelfAdjointEigenSolver<MatrixXd> axes(in_chosen(fit, fit.hessian, chosen));
  VectorXd curvatures = axes.eigenvalues().cwiseAbs();
  for (Eigen::Index k = 0; fit.curvature_deviation && k < curvatures.size(); ++k) {
    VectorXd direction = VectorXd::Zero(fit.scales.size());
    for (std::size_t i = 0; i < chosen.size(); ++i)
      direction[chosen[i]] = fit.scales[chosen[i]] * axes.eigenvectors()(static_cast<Eigen::Index>(i), k);
    curvatures[k] = std::max(curvatures[k], fit.curvature_deviation(direction));
  }
  return axes.eigenvectors() * curvatures.asDiagonal() * axes.eigenvectors().transpose();
}

// The spread of where the steps end, by the gradient's covariance, in the scaled chosen unknowns; `inverse` is that of
// their Hessian. Unknowns at a bound have no gain: their spread is that without the bound.
MatrixXd spread_of_end(const LinearisedFit& fit, const MatrixXd& noise, const MatrixXd& inverse,
                       const std::vector<int>& chosen) {
  const bool bounded = std::ranges::any_of(chosen, [&](int k) { return fit.bounds[static_cast<std::size_t>(k)] != 0; });
  if (fit.gain.size() == 0 || bounded) return inverse * noise * inverse;
  const VectorXd scales = columns(fit.scales.transpose(), chosen).transpose(), by_scales = scales.cwiseInverse();
  const auto of_chosen = [&](const MatrixXd& matrix) {
    return MatrixXd(columns(columns(matrix, chosen).transpose(), chosen).transpose());
  };
  const MatrixXd gain = by_scales.asDiagonal() * of_chosen(fit.gain) * by_scales.asDiagonal();
  MatrixXd end = gain * noise * gain.transpose();
  if (fit.start_covariance.size() == 0) return end;
  const MatrixXd left = by_scales.asDiagonal() * of_chosen(fit.left) * scales.asDiagonal(),
                 start = by_scales.asDiagonal() * of_chosen(fit.start_covariance) * by_scales.asDiagonal();
  return end + left * start * left.transpose();
}

// A covariance that noise has left with variances beyond these.
MatrixXd clamped(const MatrixXd& covariance, double least, double most) {
  const Eigen::SelfAdjointEigenSolver<MatrixXd> axes(0.5 * (covariance + covariance.transpose()));
  return axes.eigenvectors() * axes.eigenvalues().cwiseMax(least).cwiseMin(most).asDiagonal() *
         axes.eigenvectors().transpose();
}

// What is known of some of the unknowns while the others stay where they are, in units of the scales.
struct Known {
  std::vector<int> chosen;
  MatrixXd hessian;  // with the prior's and the penalties' part
  MatrixXd by_noise, total;
};

Known known_of(const LinearisedFit& fit, const std::vector<int>& chosen) {
  // All is in units of the scales, so that numbers of unlike size are inverted together.
  const auto scaled = [&](const MatrixXd& rows) { return columns(rows * fit.scales.asDiagonal(), chosen); };
  const MatrixXd jacobian = scaled(fit.jacobian);
  const MatrixXd identity = MatrixXd::Identity(jacobian.cols(), jacobian.cols());
  MatrixXd hessian = data_hessian(fit, jacobian, chosen), prior = MatrixXd::Zero(jacobian.cols(), jacobian.cols());
  for (const MatrixXd* rows : {&fit.penalty_jacobian, &fit.prior_jacobian})
    if (rows->rows() > 0) hessian += scaled(*rows).transpose() * scaled(*rows);
  if (fit.prior_jacobian.rows() > 0) prior = scaled(fit.prior_jacobian).transpose() * scaled(fit.prior_jacobian);
  const double variance = fit.mean_variance > 0
                              ? fit.mean_variance
                              : fit.residuals.squaredNorm() / static_cast<double>(fit.residuals.size());
  const double floor = 1e-12 * hessian.diagonal().maxCoeff();
  const MatrixXd noise = fit.gradient_covariance.size() > 0
                             ? in_chosen(fit, fit.gradient_covariance, chosen)
                             : MatrixXd(jacobian.transpose() * fit.variances.asDiagonal() * jacobian);
  const MatrixXd misfit = fit.misfit_covariance.size() > 0 ? in_chosen(fit, fit.misfit_covariance, chosen)
                                                           : MatrixXd::Zero(jacobian.cols(), jacobian.cols());
  const auto inverse_with = [&](double more) {
    return MatrixXd((hessian + (floor + more) * identity).ldlt().solve(identity));
  };
  // The deviation of 1 is one more piece of information on each unknown.
  const MatrixXd weak = inverse_with(variance);
  const MatrixXd by_misfit = clamped(weak * misfit * weak, 0, std::numeric_limits<double>::infinity()),
                 total = weak * (noise + variance * prior + variance * variance * identity) * weak + by_misfit;
  return {
      .chosen = chosen,
      .hessian = hessian,
      .by_noise = spread_of_end(fit, noise, inverse_with(fit.damping), chosen),
      // No direction is less certain than by a deviation of 1: where noise has made the Hessian too flat it would be.
      .total = clamped(total, 0, 1)};
}

// Moments of a distance t from the bound, over the variance without the bound.
struct OneSided {
  double truth = 0;   // E[t^2] of the t > 0 of a normal density whose middle is `beyond` deviations below 0
  double spread = 0;  // the variance of what is left of such numbers when those below 0 become 0
};

OneSided one_sided_moments(double beyond) {
  const double density = std::exp(-0.5 * beyond * beyond) / std::sqrt(2 * std::numbers::pi),
               above = 0.5 * std::erfc(beyond / std::numbers::sqrt2);
  const double square = (1 + beyond * beyond) * above - beyond * density, mean = density - beyond * above;
  return {.truth = square / above, .spread = square - mean * mean};
}

// How many of its total deviations the minimum lies beyond the bound of the last of those that `with_it` knows.
double beyond_bound(const LinearisedFit& fit, const Known& with_it) {
  const Eigen::Index last = with_it.total.rows() - 1;
  const double variance = with_it.total(last, last);
  if (fit.gradient.size() == 0 || !(variance > 0)) return 0;
  const VectorXd gradient = columns((fit.gradient.cwiseProduct(fit.scales)).transpose(), with_it.chosen).transpose();
  const double minimum = -with_it.hessian.ldlt().solve(gradient)[last];
  return std::max(0.0, fit.bounds[static_cast<std::size_t>(with_it.chosen.back())] * minimum / std::sqrt(variance));
}

// What an unknown at a bound, the last of those that `with_it` knows, adds to the covariance of all unknowns.
MatrixXd one_sided(const LinearisedFit& fit, const Known& with_it, const MatrixXd& covariance, double OneSided::*moment,
                   double beyond) {
  constexpr double kMostBeyond = 3;
  const Eigen::Index free = covariance.rows() - 1;
  const double variance = covariance(free, free);
  VectorXd moved = VectorXd::Ones(free + 1);  // all unknowns, when the one at the bound moves by 1
  if (free > 0)
    moved.head(free) = -with_it.hessian.topLeftCorner(free, free).ldlt().solve(with_it.hessian.col(free).head(free));
  return spread(variance * one_sided_moments(std::min(beyond, kMostBeyond)).*moment * moved * moved.transpose(),
                with_it.chosen, fit.scales.size());
}

}  // namespace

Certainty certainty_of(const LinearisedFit& fit) {
  const Eigen::Index unknowns = fit.jacobian.cols();
  Certainty certainty{.noise_covariance = MatrixXd::Zero(unknowns, unknowns),
                      .covariance = MatrixXd::Zero(unknowns, unknowns),
                      .at_bound = std::vector<bool>(static_cast<std::size_t>(unknowns), false),
                      .beyond_bound = VectorXd::Zero(unknowns)};
  certainty.misfit = std::sqrt(fit.residuals.squaredNorm() /
                               std::max(fit.variances.sum(), 1e-12 * fit.residuals.squaredNorm() + 1e-300));
  std::vector<int> free, bounded;
  for (int k = 0; k < unknowns; ++k) {
    const auto i = static_cast<std::size_t>(k);
    if (fit.held[i]) continue;
    certainty.at_bound[i] = fit.bounds[i] != 0;
    (certainty.at_bound[i] ? bounded : free).push_back(k);
  }
  MatrixXd by_noise = MatrixXd::Zero(unknowns, unknowns), total = by_noise;
  if (!free.empty()) {
    const Known known = known_of(fit, free);
    by_noise = spread(known.by_noise, free, unknowns);
    total = spread(known.total, free, unknowns);
  }
  for (const int k : bounded) {
    std::vector<int> with_it = free;
    with_it.push_back(k);
    const Known known = known_of(fit, with_it);
    certainty.beyond_bound[k] = beyond_bound(fit, known);
    // The minima of other noise lie around the truth, which is on this side.
    by_noise += one_sided(fit, known, known.by_noise, &OneSided::spread, 0);
    total += one_sided(fit, known, known.total, &OneSided::truth, certainty.beyond_bound[k]);
  }
  certainty.noise_covariance = fit.scales.asDiagonal() * by_noise * fit.scales.asDiagonal();
  certainty.covariance = fit.scales.asDiagonal() * total * fit.scales.asDiagonal();
  std::vector<int> varied = free;
  varied.insert(varied.end(), bounded.begin(), bounded.end());
  if (varied.empty()) return certainty;
  const MatrixXd of_varied = columns(columns(total, varied).transpose(), varied);
  const Eigen::SelfAdjointEigenSolver<MatrixXd> axes(0.5 * (of_varied + of_varied.transpose()));
  for (Eigen::Index k = axes.eigenvalues().size(); k-- > 0;) {
    VectorXd direction = VectorXd::Zero(unknowns);
    for (std::size_t i = 0; i < varied.size(); ++i)
      direction[varied[i]] = axes.eigenvectors()(static_cast<Eigen::Index>(i), k);
    certainty.weakest.push_back({direction, std::sqrt(std::max(0.0, axes.eigenvalues()[k]))});
  }
  return certainty;
}

}  // namespace inversion

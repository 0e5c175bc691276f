#include "inversion/solve/bias_free.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

namespace inversion {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

// The Hessian with eigenvalues that noise has made negative turned into positive ones.
MatrixXd made_positive(const MatrixXd& hessian) {
  constexpr double kLeast = 1e-7;  // of the largest
  const Eigen::SelfAdjointEigenSolver<MatrixXd> axes(0.5 * (hessian + hessian.transpose()));
  const double least = kLeast * std::max(axes.eigenvalues().cwiseAbs().maxCoeff(), 1e-300);
  return axes.eigenvectors() * axes.eigenvalues().cwiseAbs().cwiseMax(least).asDiagonal() *
         axes.eigenvectors().transpose();
}

// The step in the unknowns that are free, solved again without those that it would take across a bound.
VectorXd bounded_step(const BiasFreeOptions& options, const VectorXd& at, const VectorXd& gradient,
                      const MatrixXd& hessian) {
  constexpr double damping = 1e-2;
  const Eigen::Index count = at.size();
  VectorXd change = VectorXd::Zero(count);
  std::vector<bool> fixed(static_cast<std::size_t>(count), false);
  for (int k : options.held) fixed[static_cast<std::size_t>(k)] = true;
  for (Eigen::Index round = 0; round <= count; ++round) {
    std::vector<Eigen::Index> free;
    for (Eigen::Index k = 0; k < count; ++k)
      if (!fixed[static_cast<std::size_t>(k)]) free.push_back(k);
    if (free.empty()) return change;
    const auto size = static_cast<Eigen::Index>(free.size());
    MatrixXd system(size, size);
    VectorXd right(size);
    for (Eigen::Index i = 0; i < size; ++i) {
      right[i] = -gradient[free[static_cast<std::size_t>(i)]];
      for (Eigen::Index j = 0; j < size; ++j) {
        const Eigen::Index a = free[static_cast<std::size_t>(i)], b = free[static_cast<std::size_t>(j)];
        system(i, j) = hessian(a, b) * (i == j ? 1 + damping : 1.0);
      }
      // Unknowns that have been fixed at a bound move up to it.
      for (Eigen::Index k = 0; k < count; ++k)
        if (fixed[static_cast<std::size_t>(k)]) right[i] -= hessian(free[static_cast<std::size_t>(i)], k) * change[k];
    }
    const VectorXd solved = system.ldlt().solve(right);
    bool crossed = false;
    for (Eigen::Index i = 0; i < size; ++i) {
      const Eigen::Index k = free[static_cast<std::size_t>(i)];
      const double wanted = at[k] + solved[i], kept = std::clamp(wanted, options.lower[k], options.upper[k]);
      change[k] = kept - at[k];
      if (kept != wanted) fixed[static_cast<std::size_t>(k)] = crossed = true;
    }
    if (!crossed) return change;
  }
  return change;
}

}  // namespace

std::vector<double> minimise_bias_free(const BiasFreeLoss& loss, const BiasFreeOptions& options, VectorXd& unknowns) {
  MatrixXd hessian = MatrixXd::Zero(unknowns.size(), unknowns.size());
  std::vector<double> losses;
  for (int step = 0; step < options.full_steps + options.averaged_steps; ++step) {
    const BiasFreeTerms at = loss(step, unknowns);
    losses.push_back(at.loss);
    constexpr double kOld = 0.7;  // of the mean: the first steps' Hessians are of other places
    hessian = step == 0 ? at.hessian : MatrixXd(kOld * hessian + (1 - kOld) * at.hessian);
    VectorXd change = bounded_step(options, unknowns, at.gradient, made_positive(hessian));
    const double longest = change.cwiseAbs().maxCoeff();
    if (longest > options.longest) change *= options.longest / longest;
    unknowns += change / std::max(1, step - options.full_steps + 2);
  }
  return losses;
}

}  // namespace inversion

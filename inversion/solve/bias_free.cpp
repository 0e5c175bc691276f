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

// The step in the unknowns that are free, solved again without those that it would take across a bound, and shortened
// to the longest. The Hessian's diagonal is `damping` larger.
VectorXd bounded_step(const BiasFreeOptions& options, const VectorXd& at, const VectorXd& gradient,
                      const MatrixXd& hessian, double damping) {
  const Eigen::Index count = at.size();
  VectorXd change = VectorXd::Zero(count);
  std::vector<bool> fixed(static_cast<std::size_t>(count), false);
  for (int k : options.held) fixed[static_cast<std::size_t>(k)] = true;
  for (Eigen::Index round = 0; round <= count; ++round) {
    std::vector<Eigen::Index> free;
    for (Eigen::Index k = 0; k < count; ++k)
      if (!fixed[static_cast<std::size_t>(k)]) free.push_back(k);
    if (free.empty()) break;
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
    if (!crossed) break;
  }
  return change * std::min(1.0, options.longest / std::max(change.cwiseAbs().maxCoeff(), 1e-300));
}

// The mean of quadratic models of the loss, each of one set of paths.
class MeanModel {
 public:
  explicit MeanModel(Eigen::Index unknowns)
      : hessian_(MatrixXd::Zero(unknowns, unknowns)), right_(VectorXd::Zero(unknowns)) {}
  void add(const BiasFreeTerms& terms, const VectorXd& traced_at) {
    hessian_ += terms.hessian;
    right_ += terms.hessian * traced_at - terms.gradient;
    ++sets_;
  }
  int sets() const { return sets_; }
  MatrixXd hessian() const { return hessian_ / sets_; }
  VectorXd gradient(const VectorXd& unknowns) const { return (hessian_ * unknowns - right_) / sets_; }

 private:
  MatrixXd hessian_;
  VectorXd right_;
  int sets_ = 0;
};

}  // namespace

std::vector<double> minimise_bias_free(const BiasFreeLoss& loss, const BiasFreeOptions& options, VectorXd& unknowns) {
  constexpr double kOld = 0.7;  // of the running mean: the first steps' Hessians are of other places
  constexpr double kOwnDamping = 1e-2, kJointDamping = 1e-3;
  constexpr int kFewSets = 3;  // their Hessian is noisier than the running mean
  MatrixXd running;
  MeanModel joint(unknowns.size());
  std::vector<double> losses;
  for (int step = 0; step < options.own_steps + options.joint_steps; ++step) {
    const BiasFreeTerms here = loss(step, unknowns);
    BiasFreeTerms exact{.gradient = VectorXd::Zero(unknowns.size()),
                        .hessian = MatrixXd::Zero(unknowns.size(), unknowns.size())};
    if (options.exact) exact = options.exact(unknowns);
    losses.push_back(here.loss + exact.loss);
    running = step == 0 ? here.hessian : MatrixXd(kOld * running + (1 - kOld) * here.hessian);
    if (step + 1 >= options.own_steps) joint.add(here, unknowns);
    const bool alone = step < options.own_steps;
    const VectorXd gradient = (alone ? here.gradient : joint.gradient(unknowns)) + exact.gradient;
    const MatrixXd hessian = (alone || joint.sets() < kFewSets ? running : joint.hessian()) + exact.hessian;
    unknowns += bounded_step(options, unknowns, gradient, made_positive(hessian), alone ? kOwnDamping : kJointDamping);
  }
  return losses;
}

}  // namespace inversion

#include "inversion/solve/bias_free.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

namespace inversion {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kDamping = 1e-3;  // of the Hessian's diagonal

// The Hessian with eigenvalues that noise has made negative turned into positive ones.
MatrixXd made_positive(const MatrixXd& hessian) {
  constexpr double kLeast = 1e-7;  // of the largest
  const Eigen::SelfAdjointEigenSolver<MatrixXd> axes(0.5 * (hessian + hessian.transpose()));
  const double least = kLeast * std::max(axes.eigenvalues().cwiseAbs().maxCoeff(), 1e-300);
  return axes.eigenvectors() * axes.eigenvalues().cwiseAbs().cwiseMax(least).asDiagonal() *
         axes.eigenvectors().transpose();
}

// Where the quadratic model is least among the steps that keep the bounds and are not longer than the longest in any
// unknown, by the active set method (Nocedal and Wright 2006, algorithm 16.3). The Hessian is positive.
VectorXd bounded_step(const BiasFreeOptions& options, const VectorXd& at, const VectorXd& gradient, MatrixXd hessian) {
  constexpr int kMostChanges = 200;  // of the set of free unknowns; a few are usual
  hessian.diagonal() *= 1 + kDamping;
  VectorXd low = (options.lower - at).cwiseMax(-options.longest).cwiseMin(0),
           high = (options.upper - at).cwiseMin(options.longest).cwiseMax(0);
  for (int k : options.held) low[k] = high[k] = 0;
  enum class Bound { none, lower, upper };
  std::vector<Bound> active(static_cast<std::size_t>(at.size()), Bound::none);
  VectorXd step = VectorXd::Zero(at.size());
  for (int change = 0; change < kMostChanges; ++change) {
    std::vector<Eigen::Index> free;
    for (Eigen::Index k = 0; k < at.size(); ++k)
      if (active[static_cast<std::size_t>(k)] == Bound::none && low[k] < high[k]) free.push_back(k);
    const VectorXd slope = gradient + hessian * step;
    const VectorXd further = MatrixXd(hessian(free, free)).ldlt().solve(-VectorXd(slope(free)));
    double share = 1;
    Eigen::Index met = -1;
    for (std::size_t i = 0; i < free.size(); ++i) {
      const Eigen::Index k = free[i];
      const double wanted = further[static_cast<Eigen::Index>(i)], room = (wanted < 0 ? low : high)[k] - step[k];
      if (std::abs(wanted) * share > std::abs(room)) share = room / wanted, met = k;
    }
    for (std::size_t i = 0; i < free.size(); ++i) step[free[i]] += share * further[static_cast<Eigen::Index>(i)];
    if (met >= 0) {
      const bool below = further[std::find(free.begin(), free.end(), met) - free.begin()] < 0;
      step[met] = (below ? low : high)[met];
      active[static_cast<std::size_t>(met)] = below ? Bound::lower : Bound::upper;
      continue;
    }
    // The minimum with these bounds: the one is let go that it would go farthest away from.
    const VectorXd there = gradient + hessian * step;
    double most = 0;
    std::size_t released = active.size();
    for (std::size_t k = 0; k < active.size(); ++k) {
      const double slope_there = there[static_cast<Eigen::Index>(k)];
      const double inward = active[k] == Bound::lower ? -slope_there : active[k] == Bound::upper ? slope_there : 0;
      if (inward > most) most = inward, released = k;
    }
    if (released == active.size()) break;
    active[released] = Bound::none;
  }
  return step;
}

// What a step to `at` leaves of a deviation from the minimum. The Hessian contains `damping` in its diagonal.
MatrixXd left_by_step(const BiasFreeOptions& options, const VectorXd& at, MatrixXd hessian, double damping) {
  std::vector<Eigen::Index> free;
  for (Eigen::Index k = 0; k < at.size(); ++k)
    if (at[k] > options.lower[k] && at[k] < options.upper[k] &&
        std::find(options.held.begin(), options.held.end(), k) == options.held.end())
      free.push_back(k);
  const VectorXd kept = (kDamping * hessian.diagonal()).array() + damping;
  hessian.diagonal() *= 1 + kDamping;
  const MatrixXd kept_of_free = VectorXd(kept(free)).asDiagonal(),
                 left_of_free = MatrixXd(hessian(free, free)).ldlt().solve(kept_of_free);
  MatrixXd left = MatrixXd::Zero(at.size(), at.size());
  left(free, free) = left_of_free;
  return left;
}

// The mean of quadratic models of the loss, each of one set of paths.
class MeanModel {
 public:
  explicit MeanModel(Eigen::Index unknowns)
      : hessian_(MatrixXd::Zero(unknowns, unknowns)), right_(VectorXd::Zero(unknowns)) {}
  // The sets before count `old` times what they did.
  void add(const BiasFreeTerms& terms, const VectorXd& traced_at, double old) {
    hessian_ = old * hessian_ + terms.hessian;
    right_ = old * right_ + terms.hessian * traced_at - terms.gradient;
    sets_ = old * sets_ + 1;
  }
  MatrixXd hessian() const { return hessian_ / sets_; }
  VectorXd gradient(const VectorXd& unknowns) const { return (hessian_ * unknowns - right_) / sets_; }

 private:
  MatrixXd hessian_;
  VectorXd right_;
  double sets_ = 0;
};

}  // namespace

BiasFreeEnd minimise_bias_free(const BiasFreeLoss& loss, const BiasFreeOptions& options, VectorXd& unknowns) {
  MeanModel mean(unknowns.size());
  BiasFreeEnd end{.losses = {}, .left = MatrixXd::Identity(unknowns.size(), unknowns.size())};
  for (int step = 0; step < options.approach_steps + options.joint_steps; ++step) {
    const BiasFreeTerms here = loss(step, unknowns);
    BiasFreeTerms exact{.gradient = VectorXd::Zero(unknowns.size()),
                        .hessian = MatrixXd::Zero(unknowns.size(), unknowns.size())};
    if (options.exact) exact = options.exact(unknowns);
    end.losses.push_back(here.loss + exact.loss);
    mean.add(here, unknowns, step < options.approach_steps ? options.old : 1.0);
    MatrixXd hessian = mean.hessian() + exact.hessian;
    const double damping = here.variance / (options.reach * options.reach);
    hessian.diagonal().array() += damping;
    hessian = made_positive(hessian);
    unknowns += bounded_step(options, unknowns, mean.gradient(unknowns) + exact.gradient, hessian);
    end.left = left_by_step(options, unknowns, hessian, damping) * end.left;
  }
  return end;
}

}  // namespace inversion

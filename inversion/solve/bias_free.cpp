#include "inversion/solve/bias_free.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>

namespace inversion {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kDamping = 1e-6;  // of the Hessian's diagonal

// The Hessian with eigenvalues that noise has made negative turned into positive ones, and those that it hides as large
// as it.
MatrixXd made_positive(const MatrixXd& hessian, const std::function<double(const VectorXd&)>& deviation) {
  constexpr double kLeast = 1e-7;  // of the largest
  const Eigen::SelfAdjointEigenSolver<MatrixXd> axes(0.5 * (hessian + hessian.transpose()));
  const double least = kLeast * std::max(axes.eigenvalues().cwiseAbs().maxCoeff(), 1e-300);
  VectorXd curvatures = axes.eigenvalues().cwiseAbs().cwiseMax(least);
  for (Eigen::Index k = 0; deviation && k < curvatures.size(); ++k)
    curvatures[k] = std::max(curvatures[k], deviation(axes.eigenvectors().col(k)));
  return axes.eigenvectors() * curvatures.asDiagonal() * axes.eigenvectors().transpose();
}

// Where the quadratic model is least among the steps that keep the bounds and are not longer than the longest in any
// unknown, by the active set method (Nocedal and Wright 2006, algorithm 16.3). The Hessian is positive.
VectorXd bounded_step(const BiasFreeOptions& options, const VectorXd& at, const VectorXd& gradient,
                      const MatrixXd& hessian) {
  constexpr int kMostChanges = 200;  // of the set of free unknowns; a few are usual
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

// The limits' parts that a step meets.
struct Wall {
  MatrixXd hessian;
  VectorXd gradient;  // at the step's beginning
};

Wall wall_of(const BiasFreeOptions::Limits& limits, const std::vector<bool>& met) {
  Wall wall{.hessian = MatrixXd::Zero(limits.rows.cols(), limits.rows.cols()),
            .gradient = VectorXd::Zero(limits.rows.cols())};
  for (std::size_t i = 0; i < met.size(); ++i) {
    if (!met[i]) continue;
    const auto row = limits.rows.row(static_cast<Eigen::Index>(i));
    wall.hessian += row.transpose() * row;
    wall.gradient += limits.values[static_cast<Eigen::Index>(i)] * row.transpose();
  }
  return wall;
}

std::vector<bool> met_behind(const BiasFreeOptions::Limits& limits, const VectorXd& step) {
  std::vector<bool> met;
  for (const double value : VectorXd(limits.values + limits.rows * step)) met.push_back(value > 0);
  return met;
}

// The step that keeps the bounds, and the Hessian of what it minimises: `gradient` and `hessian` are without the
// limits, of which those count that are met behind the step. Newton's method for such convex piecewise quadratics, each
// time as far as they fall.
std::pair<VectorXd, MatrixXd> limited_step(const BiasFreeOptions& options, const BiasFreeOptions::Limits& limits,
                                           const VectorXd& at, const VectorXd& gradient, const MatrixXd& hessian) {
  constexpr int kMostChanges = 100, kHalvings = 40;
  VectorXd step = VectorXd::Zero(at.size());
  std::vector<bool> met = met_behind(limits, step);
  for (int change = 0;; ++change) {
    const Wall wall = wall_of(limits, met);
    const VectorXd way = bounded_step(options, at, gradient + wall.gradient, hessian + wall.hessian) - step;
    const auto falls_at = [&](double share) {
      const VectorXd there = step + share * way;
      const Wall behind = wall_of(limits, met_behind(limits, there));
      return way.dot(gradient + behind.gradient + (hessian + behind.hessian) * there) <= 0;
    };
    double share = 1;
    if (!falls_at(1)) {
      double falls = 0;
      for (int halving = 0; halving < kHalvings; ++halving)
        (falls_at(0.5 * (falls + share)) ? falls : share) = 0.5 * (falls + share);
      share = falls;
    }
    step += share * way;
    std::vector<bool> then = met_behind(limits, step);
    if ((share == 1 && then == met) || share == 0 || change == kMostChanges) return {step, hessian + wall.hessian};
    met = std::move(then);
  }
}

// The inverse of the Hessian in the unknowns that a step to `at` leaves free, 0 in the others.
MatrixXd inverse_of_free(const BiasFreeOptions& options, const VectorXd& at, const MatrixXd& hessian) {
  std::vector<Eigen::Index> free;
  for (Eigen::Index k = 0; k < at.size(); ++k)
    if (at[k] > options.lower[k] && at[k] < options.upper[k] &&
        std::find(options.held.begin(), options.held.end(), k) == options.held.end())
      free.push_back(k);
  const auto count = static_cast<Eigen::Index>(free.size());
  const MatrixXd of_free = MatrixXd(hessian(free, free)).ldlt().solve(MatrixXd::Identity(count, count));
  MatrixXd inverse = MatrixXd::Zero(at.size(), at.size());
  inverse(free, free) = of_free;
  return inverse;
}

}  // namespace

BiasFreeEnd minimise_bias_free(const BiasFreeLoss& loss, const BiasFreeOptions& options, VectorXd& unknowns) {
  BiasFreeEnd end{.losses = {},
                  .left = MatrixXd::Identity(unknowns.size(), unknowns.size()),
                  .gain = MatrixXd::Zero(unknowns.size(), unknowns.size())};
  for (int step = 0; step < options.approach_steps + options.joint_steps; ++step) {
    const BiasFreeTerms here = loss(step, unknowns, step < options.approach_steps ? options.old : 1.0);
    BiasFreeTerms exact{.gradient = VectorXd::Zero(unknowns.size()),
                        .hessian = MatrixXd::Zero(unknowns.size(), unknowns.size())};
    if (options.exact) exact = options.exact(unknowns);
    BiasFreeOptions::Limits limits{.values = VectorXd(0), .rows = MatrixXd(0, unknowns.size())};
    if (options.limits) limits = options.limits(unknowns);
    end.losses.push_back(here.loss + exact.loss + 0.5 * limits.values.cwiseMax(0).squaredNorm());
    MatrixXd hessian = here.hessian + exact.hessian;
    const VectorXd damping =
        (kDamping * hessian.diagonal()).cwiseAbs().array() + here.variance / (options.reach * options.reach);
    hessian = made_positive(hessian, here.curvature_deviation);
    hessian.diagonal() += damping;
    VectorXd moved;
    std::tie(moved, hessian) = limited_step(options, limits, unknowns, here.gradient + exact.gradient, hessian);
    unknowns += moved;
    const MatrixXd inverse = inverse_of_free(options, unknowns, hessian), left = inverse * damping.asDiagonal();
    end.left = left * end.left;
    end.gain = left * end.gain + inverse;
  }
  return end;
}

}  // namespace inversion

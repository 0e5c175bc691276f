#include "renderer/weave/minimizer.h"

#include <Eigen/SparseCholesky>
#include <algorithm>
#include <cmath>
#include <deque>

namespace renderer {
namespace {

using Eigen::VectorXd;

struct Place {
  VectorXd x, gradient;
  double energy = 0;
};

double largest(const VectorXd& v) {
  return v.size() ? v.cwiseAbs().maxCoeff() : 0;
}

// Halves the step until the energy falls by a tenth of what the slope promises (less lets Newton hop between two sets
// of touching samples); returns false when no step does. Where the promised fall is lost in rounding, the gradient
// decides.
bool search_line(const Objective& objective, const VectorXd& direction, double first_length, Place& place) {
  constexpr double kArmijo = 0.1, kRounding = 1e-13;
  constexpr int kMostHalvings = 30;
  const double slope = direction.dot(place.gradient);
  Place next;
  double length = first_length;
  for (int halving = 0; halving < kMostHalvings; ++halving, length /= 2) {
    next.x = place.x + length * direction;
    next.energy = objective.value(next.x, next.gradient);
    if (!std::isfinite(next.energy)) continue;
    const double noise = kRounding * std::abs(place.energy);
    const bool falls = next.energy <= place.energy + kArmijo * length * slope;
    const bool even = std::abs(length * slope) <= noise && largest(next.gradient) < largest(place.gradient);
    if (!falls && !even) continue;
    place = std::move(next);
    return true;
  }
  return false;
}

class QuasiNewton {
 public:
  VectorXd direction(const VectorXd& gradient) const {
    VectorXd d = -gradient;
    std::vector<double> alpha(pairs_.size());
    for (std::size_t i = pairs_.size(); i-- > 0;) {
      alpha[i] = pairs_[i].rho * pairs_[i].move.dot(d);
      d -= alpha[i] * pairs_[i].change;
    }
    if (!pairs_.empty()) d /= pairs_.back().rho * pairs_.back().change.squaredNorm();
    for (std::size_t i = 0; i < pairs_.size(); ++i)
      d += (alpha[i] - pairs_[i].rho * pairs_[i].change.dot(d)) * pairs_[i].move;
    return d;
  }
  void learn(const VectorXd& move, const VectorXd& change) {
    const double product = move.dot(change);
    if (product <= 1e-10 * move.norm() * change.norm()) return;
    pairs_.push_back({move, change, 1 / product});
    if (pairs_.size() > kMemory) pairs_.pop_front();
  }
  bool forget() {
    const bool knew = !pairs_.empty();
    pairs_.clear();
    return knew;
  }

 private:
  static constexpr std::size_t kMemory = 20;
  struct Pair {
    VectorXd move, change;
    double rho;
  };
  std::deque<Pair> pairs_;
};

void run_quasi_newton(const Objective& objective, const MinimizerOptions& options, Place& place,
                      MinimizerReport& report) {
  QuasiNewton memory;
  const double goal = std::max(options.newton_below, options.gradient_goal);
  for (int step = 0; step < options.most_quasi_newton && largest(place.gradient) > goal; ++step) {
    VectorXd direction = memory.direction(place.gradient);
    if (direction.dot(place.gradient) >= 0) {
      memory.forget();
      direction = -place.gradient;
    }
    const double cap = options.largest_move / largest(direction);
    const Place before = place;
    if (!search_line(objective, direction, std::min(1.0, cap), place)) {
      if (!memory.forget()) return;
      continue;
    }
    memory.learn(place.x - before.x, place.gradient - before.gradient);
    ++report.quasi_newton_steps;
  }
}

// The factors of the second derivatives. One thread makes them, so that the bits are the same everywhere; their
// diagonal tells how many eigenvalues are negative.
class Factorization {
 public:
  // Factorizes the matrix + shift x its mean diagonal; returns false where that is not positive definite.
  bool compute(BorderedMatrix matrix, double shift, MinimizerReport& report) {
    const Eigen::Index unknowns = matrix.lower.rows() - matrix.borders;
    const Eigen::VectorXd diagonal = matrix.lower.diagonal().head(unknowns);
    const double mean = diagonal.cwiseAbs().mean();
    for (Eigen::Index i = 0; i < unknowns; ++i) matrix.lower.coeffRef(i, i) += shift * mean;
    borders_ = matrix.borders;
    ++report.factorizations;
    solver_.compute(matrix.lower);
    return solver_.info() == Eigen::Success && (solver_.vectorD().array() < 0).count() == borders_;
  }
  VectorXd solve(const VectorXd& right) const {
    VectorXd bordered = VectorXd::Zero(right.size() + borders_);
    bordered.head(right.size()) = right;
    return solver_.solve(bordered).head(right.size());
  }

 private:
  Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>, Eigen::Lower> solver_;
  Eigen::Index borders_ = 0;
};

// Newton's direction with the true second derivatives or, where these lead uphill somewhere, with their positive part.
// (Adding shifts to the true ones, eight times larger until one worked, took twice the factorizations for no fewer
// steps.)
VectorXd newton_direction(const Objective& objective, const Place& place, MinimizerReport& report) {
  constexpr double kShift = 1e-9, kPositiveShift = 1e-6;  // of the mean diagonal
  Factorization factors;
  if (!factors.compute(objective.hessian(place.x, true), kShift, report))
    factors.compute(objective.hessian(place.x, false), kPositiveShift, report);
  return -factors.solve(place.gradient);
}

void run_newton(const Objective& objective, const MinimizerOptions& options, Place& place, MinimizerReport& report) {
  for (int step = 0; step < options.most_newton && largest(place.gradient) > options.gradient_goal; ++step) {
    VectorXd direction = newton_direction(objective, place, report);
    if (!direction.allFinite() || direction.dot(place.gradient) >= 0) direction = -place.gradient;
    const double length = std::min(1.0, options.largest_move / largest(direction));
    if (!search_line(objective, direction, length, place)) return;
    ++report.newton_steps;
  }
}

}  // namespace

MinimizerReport minimize(const Objective& objective, const MinimizerOptions& options, VectorXd& x) {
  MinimizerReport report;
  Place place{.x = x};
  place.energy = objective.value(place.x, place.gradient);
  run_quasi_newton(objective, options, place, report);
  run_newton(objective, options, place, report);
  x = place.x;
  report.energy = place.energy;
  report.gradient = largest(place.gradient);
  report.converged = report.gradient <= options.gradient_goal;
  return report;
}

}  // namespace renderer

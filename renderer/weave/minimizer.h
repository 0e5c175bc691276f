// Minimizer of smooth energies of many unknowns: limited-memory BFGS from afar, Newton's method to the end.
//
// No step moves an unknown by more than a cap, so that yarns cannot pass through each other in one step, and each step
// lowers the energy (Armijo). From the shapes of yarn_path.h Newton alone needs half the time of L-BFGS followed by Newton
// (measured on all ready weaves), so L-BFGS is an option. Everything is sequential: the same start ends in the same place.
// Source: Nocedal and Wright 2006, algorithms 7.4 (L-BFGS) and 3.2 (line-search Newton). Ceres' L-BFGS was not taken:
// its line search cannot cap the step.
#pragma once

#include <Eigen/Core>
#include <functional>

#include "renderer/weave/weave_model.h"

namespace renderer {

struct Objective {
  std::function<double(const Eigen::VectorXd&, Eigen::VectorXd& gradient)> value;
  // `exact` or a positive semidefinite part.
  std::function<BorderedMatrix(const Eigen::VectorXd&, bool exact)> hessian;
};

struct MinimizerOptions {
  double largest_move = 0.1;    // of one unknown in one step
  double gradient_goal = 1e-8;  // largest component
  double newton_below = 0.0;    // L-BFGS until the largest component is below this ...
  int most_quasi_newton = 0;    // ... or for so many steps
  int most_newton = 200;
};

struct MinimizerReport {
  int quasi_newton_steps = 0, newton_steps = 0, factorizations = 0;
  double energy = 0.0;
  double gradient = 0.0;   // largest component at the end
  bool converged = false;  // gradient_goal reached
};

MinimizerReport minimize(const Objective& objective, const MinimizerOptions& options, Eigen::VectorXd& x);

}  // namespace renderer

// A minimizer of smooth energies of many unknowns: limited-memory BFGS far from the minimum, Newton's method near it.
//
// No step moves an unknown by more than a cap, so that yarns cannot pass through each other in one step, and each step
// lowers the energy (Armijo). From the shapes of yarn_path.h Newton's method alone needs half the time of L-BFGS
// followed by it (measured on all ready weaves), so that L-BFGS is an option. Everything is sequential: the same start
// ends in the same place. Source: Nocedal and Wright 2006, algorithms 7.4 (L-BFGS) and 3.2 (line-search Newton). Ceres'
// L-BFGS was not taken, because its line search cannot cap the step.
#pragma once

#include <Eigen/Core>
#include <functional>

#include "renderer/weave/weave_model.h"

namespace renderer {

struct Objective {
  std::function<double(const Eigen::VectorXd&, Eigen::VectorXd& gradient)> value;
  // The second derivatives: the exact ones, or a positive semidefinite part of them.
  std::function<BorderedMatrix(const Eigen::VectorXd&, bool exact)> hessian;
};

struct MinimizerOptions {
  double largest_move = 0.1;    // of one unknown in one step, the cap
  double gradient_goal = 1e-8;  // the search ends when the gradient's largest component is below this
  double newton_below = 0.0;    // L-BFGS runs until the largest component is below this ...
  int most_quasi_newton = 0;    // ... or for this many steps
  int most_newton = 200;
};

struct MinimizerReport {
  int quasi_newton_steps = 0, newton_steps = 0, factorizations = 0;
  double energy = 0.0;
  double gradient = 0.0;   // largest component at the end
  bool converged = false;  // gradient_goal reached
};

// Minimizes the objective from x on, and leaves in x the lowest place found.
MinimizerReport minimize(const Objective& objective, const MinimizerOptions& options, Eigen::VectorXd& x);

}  // namespace renderer

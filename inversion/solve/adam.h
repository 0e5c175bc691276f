// Adam, the paper's optimiser [Xia 2025, section 4; Kingma and Ba 2015]: gradient steps of the stochastic loss, clamped
// to the bounds after each.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <vector>

namespace inversion {

struct AdamOptions {
  int steps = 100;
  double rate = 1e-2;
  double first_decay = 0.9, second_decay = 0.999, epsilon = 1e-8;
};

// A loss: evaluate(step, unknowns, gradient) returns it with fresh light paths every time; what it throws ends the
// search.
using StochasticLoss = std::function<double(int step, const Eigen::VectorXd& unknowns, Eigen::VectorXd& gradient)>;

// Minimises the loss; returns the losses met on the way, one a step. `unknowns` ends where the last step led.
std::vector<double> minimise_by_adam(const StochasticLoss& evaluate, const AdamOptions& options,
                                     const Eigen::VectorXd& lower, const Eigen::VectorXd& upper,
                                     Eigen::VectorXd& unknowns);

}  // namespace inversion

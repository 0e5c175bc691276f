#include "inversion/solve/adam.h"

#include <cmath>

namespace inversion {

std::vector<double> minimise_by_adam(const StochasticLoss& evaluate, const AdamOptions& options,
                                     const Eigen::VectorXd& lower, const Eigen::VectorXd& upper,
                                     Eigen::VectorXd& unknowns) {
  Eigen::ArrayXd first = Eigen::ArrayXd::Zero(unknowns.size()), second = first;
  Eigen::VectorXd gradient(unknowns.size());
  std::vector<double> losses;
  for (int step = 1; step <= options.steps; ++step) {
    losses.push_back(evaluate(step, unknowns, gradient));
    first = options.first_decay * first + (1 - options.first_decay) * gradient.array();
    second = options.second_decay * second + (1 - options.second_decay) * gradient.array().square();
    const Eigen::ArrayXd mean = first / (1 - std::pow(options.first_decay, step));
    const Eigen::ArrayXd spread = (second / (1 - std::pow(options.second_decay, step))).sqrt();
    unknowns.array() -= options.rate * mean / (spread + options.epsilon);
    unknowns = unknowns.cwiseMax(lower).cwiseMin(upper);
  }
  return losses;
}

}  // namespace inversion

#include "inversion/fit/misfit_comparison.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "inversion/fit/noise_weights.h"

namespace inversion {

using Eigen::VectorXd;

// The products are those of all pairs of halves of all sets of paths, whose noise falls with the number of sets, and
// not with its root as that of each set's own halves.
void MisfitComparison::add(const VectorXd& unknowns, const std::function<void()>& step) {
  constexpr double kColours = 3;
  const VectorXd zero = VectorXd::Zero(objective_.residual_count());
  VectorXd variances = zero, sum = zero, squares = zero;
  for (int set = 1; set <= sets_; ++set) {
    objective_.trace(unknowns, kPaths, seed_of_trace(options_, -set), [](int, int) {});
    const ViewObjective::Halves both = objective_.halves(unknowns, false);
    variances += both.variances / sets_;
    for (const VectorXd& half : both.residuals) sum += half, squares += half.cwiseAbs2();
    step();
  }
  const double halves = 2.0 * sets_, pairs = halves * (halves - 1);
  const VectorXd products = (sum.cwiseAbs2() - squares) / pairs,
                 noise = (squares - sum.cwiseAbs2() / halves) / pairs;  // of the halves' mean
  seen_.push_back(
      {.variances = variances,
       .products = products - objective_.photograph_variances(),
       .product_variances = kColours * (2 * noise.cwiseAbs2() + 4 * products.cwiseMax(0).cwiseProduct(noise))});
}

std::vector<std::size_t> MisfitComparison::from_nearest() const {
  NoiseWeights weights(views_and_colours(objective_));
  for (const Seen& one : seen_) weights.add(one.variances, one.products);
  const VectorXd squares = weights.factors().cwiseAbs2();
  const auto misfit = [&](std::size_t number) {
    const Seen& one = seen_[number];
    return one.products.dot(squares) + std::sqrt(one.product_variances.dot(squares.cwiseAbs2()));
  };
  std::vector<std::size_t> numbers(seen_.size());
  std::iota(numbers.begin(), numbers.end(), std::size_t{0});
  std::ranges::sort(numbers, {}, misfit);
  return numbers;
}

}  // namespace inversion

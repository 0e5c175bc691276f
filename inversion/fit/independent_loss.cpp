#include "inversion/fit/independent_loss.h"

#include <algorithm>
#include <cmath>

#include "inversion/fit/view_objective.h"

namespace inversion {

IndependentLoss independent_loss(const WrappedSpool& spool, const std::vector<View>& views, const ViewFit& fit,
                                 int paths_per_block, int repetitions, std::uint64_t seed, int block_stride) {
  ViewObjective objective(spool, views, fit.family, block_stride);
  Eigen::VectorXd residuals(objective.residual_count());
  double sum = 0, squares = 0;
  Eigen::VectorXd together = Eigen::VectorXd::Zero(residuals.size());
  for (int i = 0; i < repetitions; ++i) {
    objective.trace(fit.unknowns, paths_per_block, seed + kFitSeedStep * static_cast<std::uint64_t>(i),
                    [](int, int) {});
    objective.residuals(fit.unknowns, residuals.data(), nullptr);
    const double loss = 0.5 * residuals.squaredNorm();
    sum += loss;
    squares += loss * loss;
    together += residuals;
  }
  const double mean = sum / repetitions;
  const double variance = std::max(0.0, squares / repetitions - mean * mean) / (repetitions - 1);
  return {.mean = mean,
          .standard_error = std::sqrt(variance),
          .without_noise = (0.5 * together.squaredNorm() - sum) / (repetitions * (repetitions - 1))};
}

}  // namespace inversion

#include "inversion/fit/independent_loss.h"

#include <algorithm>
#include <cmath>

#include "inversion/fit/view_objective.h"

namespace inversion {
namespace {

IndependentLoss loss_of(ViewObjective& objective, const Eigen::VectorXd& unknowns, const Eigen::VectorXd& scales,
                        int paths_per_block, int repetitions, std::uint64_t seed) {
  Eigen::VectorXd residuals(objective.residual_count());
  double sum = 0, squares = 0;
  Eigen::VectorXd together = Eigen::VectorXd::Zero(residuals.size());
  for (int i = 0; i < repetitions; ++i) {
    objective.trace(unknowns, paths_per_block, seed + kFitSeedStep * static_cast<std::uint64_t>(i), [](int, int) {});
    objective.residuals(unknowns, residuals.data(), nullptr);
    residuals.array() *= scales.array();
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

}  // namespace

IndependentLoss independent_loss(const WrappedSpool& spool, const std::vector<View>& views, const ViewFit& fit,
                                 int paths_per_block, int repetitions, std::uint64_t seed) {
  ViewObjective objective(spool, views, fit.family);
  const Eigen::VectorXd scales = Eigen::VectorXd::Ones(objective.residual_count());
  return loss_of(objective, fit.unknowns, scales, paths_per_block, repetitions, seed);
}

double relative_misfit(const WrappedSpool& spool, const std::vector<View>& views, const ViewFit& fit,
                       int paths_per_block, int repetitions, std::uint64_t seed, int block_stride) {
  ViewObjective objective(spool, views, fit.family, block_stride);
  return 2 * loss_of(objective, fit.unknowns, objective.relative_scales(), paths_per_block, repetitions, seed)
                 .without_noise;
}

}  // namespace inversion

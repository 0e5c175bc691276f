#include "inversion/fit/noise_weights.h"

#include <algorithm>
#include <cmath>
#include <map>

namespace inversion {

using Eigen::VectorXd;

void NoiseWeights::add(const VectorXd& variances, const VectorXd& products) {
  const VectorXd pooled = mean_of_groups(variances);
  variances_ = empty() ? pooled : VectorXd((old_ * sets_ * variances_ + pooled) / (old_ * sets_ + 1.0));
  const double misfit = misfit_of(products);
  misfit_ = empty() ? misfit : std::min(misfit, last_misfit_);
  last_misfit_ = misfit;
  if (empty()) first_ = variances_.mean();
  sets_ = old_ * sets_ + 1;
}

double NoiseWeights::misfit_of(const VectorXd& products) const {
  constexpr int kIterations = 30;
  constexpr double kSure = 3;      // deviations
  constexpr double kLeast = 1e-3;  // of the mean variance
  const double least = kLeast * variances_.mean(), of_all = products.mean();
  double misfit = std::max(of_all, least);
  for (int i = 0; i < kIterations; ++i) {
    const VectorXd weights = (variances_.array() + misfit).inverse().square();
    misfit = std::max(weights.dot(products) / weights.sum(), least);
  }
  // Each half has twice the variance of both, so that a product's is four times its square.
  const double uncertain =
      std::sqrt(std::max(products.squaredNorm(), 4 * variances_.squaredNorm())) / static_cast<double>(products.size());
  return std::max(misfit, of_all - kSure * uncertain);
}

VectorXd NoiseWeights::mean_of_groups(const VectorXd& values) const {
  std::map<int, std::pair<double, int>> sums;
  for (std::size_t i = 0; i < groups_.size(); ++i) {
    auto& [sum, count] = sums[groups_[i]];
    sum += values[static_cast<Eigen::Index>(i)];
    ++count;
  }
  VectorXd means(values.size());
  for (std::size_t i = 0; i < groups_.size(); ++i) {
    const auto& [sum, count] = sums[groups_[i]];
    means[static_cast<Eigen::Index>(i)] = sum / count;
  }
  return means;
}

double NoiseWeights::variance_alike(const VectorXd& photographs) const {
  return std::min(weighted_variance(), (factors().array().square() * (photographs.array() + misfit_)).mean());
}

double NoiseWeights::weighted_variance() const {
  const double noise = variances_.mean();
  return (noise + misfit_) * (noise > 0 ? first_ / noise : 1);
}

VectorXd NoiseWeights::factors() const {
  const Eigen::ArrayXd whole = variances_.array() + misfit_;
  return (weighted_variance() / whole).sqrt();
}

}  // namespace inversion

#include "inversion/solve/joined_sets.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>

namespace inversion {

using Eigen::MatrixXd;
using Eigen::VectorXd;

void JoinedSets::add(const std::array<VectorXd, 2>& residuals, const std::array<MatrixXd, 2>& jacobians,
                     const VectorXd& unknowns, double old) {
  const Eigen::Index count = unknowns.size(), rows = residuals[0].size();
  if (empty()) {
    sums_ = MatrixXd::Zero(count + 1, rows);
    noise_ = MatrixXd::Zero((count + 1) * (count + 1), rows);
  }
  weights_ = old * weights_ + 1;
  squares_ = old * old * squares_ + 1;
  sums_ *= old;
  noise_ *= old * old;
  const auto half = [&](std::size_t h) {
    MatrixXd numbers(count + 1, rows);
    numbers.topRows(count) = jacobians[h].transpose();
    numbers.row(count) = (residuals[h] - jacobians[h] * unknowns).transpose();
    return numbers;
  };
  const MatrixXd a = half(0), b = half(1), apart = 0.5 * (a - b);
  sums_ += 0.5 * (a + b);
  for (Eigen::Index row = 0; row < rows; ++row)
    noise_.col(row).reshaped(count + 1, count + 1) += apart.col(row) * apart.col(row).transpose();
}

BiasFreeTerms JoinedSets::at(const VectorXd& unknowns) const {
  const VectorXd at = unknowns.homogeneous(), noise = noise_.rowwise().sum();
  const double squares = (sums_.transpose() * at).squaredNorm() - at.dot(noise.reshaped(at.size(), at.size()) * at);
  return {.loss = 0.5 * squares / (weights_ * weights_),
          .gradient = gradients(unknowns).rowwise().sum(),
          .hessian = hessian()};
}

MatrixXd JoinedSets::gradients(const VectorXd& unknowns) const {
  const Eigen::Index count = unknowns.size();
  const VectorXd at = unknowns.homogeneous();
  MatrixXd gradients = sums_.topRows(count) * (sums_.transpose() * at).asDiagonal();
  for (Eigen::Index row = 0; row < gradients.cols(); ++row)
    gradients.col(row) -= noise_.col(row).reshaped(count + 1, count + 1).topRows(count) * at;
  return gradients / (weights_ * weights_);
}

MatrixXd JoinedSets::hessian() const {
  const Eigen::Index count = sums_.rows() - 1;
  const VectorXd noise = noise_.rowwise().sum();
  return whole_hessian() - noise.reshaped(count + 1, count + 1).topLeftCorner(count, count) / (weights_ * weights_);
}

// For each residual v' H v contains s^2 - n, with s = J v of the sets' sum and n the variance of s; s^2 varies by
// 4 (s^2 - n) n + 2 n^2.
double JoinedSets::curvature_deviation(const VectorXd& direction) const {
  const Eigen::Index count = direction.size();
  const VectorXd slopes = sums_.topRows(count).transpose() * direction;
  double variance = 0;
  for (Eigen::Index row = 0; row < slopes.size(); ++row) {
    const double square = slopes[row] * slopes[row],
                 noise = direction.dot(noise_.col(row).reshaped(count + 1, count + 1).topLeftCorner(count, count) *
                                       direction);
    variance += 4 * std::max(0.0, square - noise) * noise + 2 * noise * noise;
  }
  return std::sqrt(variance) / (weights_ * weights_);
}

MatrixXd JoinedSets::misfit_covariance(const VectorXd& unknowns, const std::vector<int>& groups,
                                       const VectorXd& variances) const {
  struct Group {
    double excess = 0;
    int count = 0;
    VectorXd rows;
    MatrixXd noise;  // of `rows`
  };
  const Eigen::Index count = unknowns.size();
  const VectorXd at = unknowns.homogeneous(), residuals = sums_.transpose() * at / weights_;
  std::map<int, Group> sums;
  for (Eigen::Index row = 0; row < residuals.size(); ++row) {
    Group& group = sums[groups[static_cast<std::size_t>(row)]];
    if (group.count++ == 0) group.rows = VectorXd::Zero(count), group.noise = MatrixXd::Zero(count, count);
    const auto noise = noise_.col(row).reshaped(count + 1, count + 1);
    group.excess += residuals[row] * residuals[row] - at.dot(noise * at) / (weights_ * weights_) - variances[row];
    group.rows += sums_.col(row).head(count) / weights_;
    group.noise += noise.topLeftCorner(count, count) / (weights_ * weights_);
  }
  MatrixXd part = MatrixXd::Zero(count, count);
  for (const auto& [number, group] : sums)
    part += std::max(0.0, group.excess / group.count) * (group.rows * group.rows.transpose() - group.noise);
  return part;
}

MatrixXd JoinedSets::whole_hessian() const {
  const auto jacobians = sums_.topRows(sums_.rows() - 1);
  return jacobians * jacobians.transpose() / (weights_ * weights_);
}

}  // namespace inversion

#include "inversion/fit/loss_terms.h"

#include <ceres/crs_matrix.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

namespace inversion {

using Eigen::VectorXd;

// The prior's unknowns are a thread's last ones, in the same order.
static_assert(kBeta + 3 == kL0 && kBeta + renderer::kPriorUnknownCount == renderer::kThreadParameterCount);

DataTerm::DataTerm(const ViewObjective& objective, int unknowns) : objective_(objective), unknowns_(unknowns) {
  set_num_residuals(objective.residual_count());
  mutable_parameter_block_sizes()->push_back(unknowns);
}

bool DataTerm::Evaluate(double const* const* parameters, double* residuals, double** jacobians) const {
  objective_.residuals(Eigen::Map<const VectorXd>(parameters[0], unknowns_), residuals,
                       jacobians ? jacobians[0] : nullptr);
  return true;
}

PriorTerm::PriorTerm(double weight) {
  const renderer::ThreadPrior& prior = renderer::simulated_thread_prior();
  jacobian_.setZero();
  const renderer::PriorMatrix root = prior.covariance.llt().matrixL();
  jacobian_.rightCols<renderer::kPriorUnknownCount>() =
      std::sqrt(weight) * root.triangularView<Eigen::Lower>().solve(renderer::PriorMatrix::Identity());
  mean_.setZero();
  mean_.tail<renderer::kPriorUnknownCount>() = prior.mean;
  set_num_residuals(renderer::kPriorUnknownCount);
  mutable_parameter_block_sizes()->push_back(renderer::kThreadParameterCount);
}

double PriorTerm::loss(const VectorXd& unknowns) const {
  return 0.5 * (jacobian_ * (unknowns - mean_)).squaredNorm();
}

bool PriorTerm::Evaluate(double const* const* parameters, double* residuals, double** jacobians) const {
  Eigen::Map<Eigen::Matrix<double, renderer::kPriorUnknownCount, 1>> values(residuals);
  values = jacobian_ * (Eigen::Map<const ThreadUnknowns>(parameters[0]) - mean_);
  if (jacobians && jacobians[0]) std::copy_n(jacobian_.data(), jacobian_.size(), jacobians[0]);
  return true;
}

OtherTerms::OtherTerms(const ScatteringFamily& family, double prior_weight) : at_(unknowns_of(family).lower.size()) {
  problem_.AddParameterBlock(at_.data(), static_cast<int>(at_.size()));
  add_penalties(family, problem_, at_.data());
  if (prior_weight > 0) problem_.AddResidualBlock(new PriorTerm(prior_weight), nullptr, at_.data());
}

BiasFreeTerms OtherTerms::at(const VectorXd& unknowns) {
  at_ = unknowns;
  BiasFreeTerms terms;
  terms.gradient = VectorXd::Zero(unknowns.size());
  terms.hessian = Eigen::MatrixXd::Zero(unknowns.size(), unknowns.size());
  if (problem_.NumResiduals() == 0) return terms;
  std::vector<double> gradient;
  problem_.Evaluate({}, &terms.loss, nullptr, &gradient, nullptr);
  terms.gradient = Eigen::Map<const VectorXd>(gradient.data(), unknowns.size());
  const Eigen::MatrixXd rows = jacobian(unknowns);
  terms.hessian = rows.transpose() * rows;
  return terms;
}

Eigen::MatrixXd OtherTerms::jacobian(const VectorXd& unknowns) {
  if (problem_.NumResiduals() == 0) return Eigen::MatrixXd(0, unknowns.size());
  at_ = unknowns;
  ceres::CRSMatrix sparse;
  problem_.Evaluate({}, nullptr, nullptr, nullptr, &sparse);
  Eigen::MatrixXd dense = Eigen::MatrixXd::Zero(sparse.num_rows, at_.size());
  for (int row = 0; row < sparse.num_rows; ++row)
    for (auto i = static_cast<std::size_t>(sparse.rows[static_cast<std::size_t>(row)]);
         i < static_cast<std::size_t>(sparse.rows[static_cast<std::size_t>(row) + 1]); ++i)
      dense(row, sparse.cols[i]) = sparse.values[i];
  return dense;
}

}  // namespace inversion

#include "inversion/fit/loss_terms.h"

#include <ceres/crs_matrix.h>
#include <ceres/loss_function.h>
#include <ceres/sized_cost_function.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <utility>

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

namespace {

constexpr double kTailDegrees = 4;  // nu
constexpr double kAtMean = (kTailDegrees + 1) / kTailDegrees;

// One of z, for Ceres.
class WhitenedUnknown : public ceres::SizedCostFunction<1, renderer::kThreadParameterCount> {
 public:
  using Row = Eigen::Matrix<double, 1, renderer::kThreadParameterCount>;

  WhitenedUnknown(Row row, ThreadUnknowns mean) : row_(std::move(row)), mean_(std::move(mean)) {}
  bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override {
    residuals[0] = row_.dot(Eigen::Map<const ThreadUnknowns>(parameters[0]) - mean_);
    if (jacobians && jacobians[0]) std::copy_n(row_.data(), row_.size(), jacobians[0]);
    return true;
  }

 private:
  Row row_;
  ThreadUnknowns mean_;
};

}  // namespace

ThreadPriorTerm::ThreadPriorTerm(double weight) : weight_(weight) {
  const renderer::ThreadPrior& prior = renderer::simulated_thread_prior();
  whitening_.setZero();
  const renderer::PriorMatrix root = prior.covariance.llt().matrixL();
  whitening_.rightCols<renderer::kPriorUnknownCount>() =
      root.triangularView<Eigen::Lower>().solve(renderer::PriorMatrix::Identity());
  mean_.setZero();
  mean_.tail<renderer::kPriorUnknownCount>() = prior.mean;
}

ThreadPriorTerm::Whitened ThreadPriorTerm::weights(const Whitened& z) const {
  return weight_ * kAtMean / (1 + z.array().square() / kTailDegrees);
}

double ThreadPriorTerm::loss(const VectorXd& unknowns) const {
  return weight_ * kAtMean * kTailDegrees / 2 * (whitened(unknowns).array().square() / kTailDegrees).log1p().sum();
}

BiasFreeTerms ThreadPriorTerm::at(const VectorXd& unknowns) const {
  const Whitened z = whitened(unknowns), here = weights(z);
  return {.loss = loss(unknowns),
          .gradient = whitening_.transpose() * here.cwiseProduct(z),
          .hessian = whitening_.transpose() * here.asDiagonal() * whitening_};
}

ThreadPriorTerm::Rows ThreadPriorTerm::known_rows(const VectorXd& unknowns) const {
  const Whitened z = whitened(unknowns);
  const Whitened positive = (1 - 2 * z.array().square() / (kTailDegrees + z.array().square())).cwiseMax(0);
  return weights(z).cwiseProduct(positive).cwiseSqrt().asDiagonal() * whitening_;
}

void ThreadPriorTerm::add_to(ceres::Problem& problem, double* unknowns) const {
  for (Eigen::Index k = 0; k < whitening_.rows(); ++k)
    problem.AddResidualBlock(
        new WhitenedUnknown(whitening_.row(k), mean_),
        new ceres::ScaledLoss(new ceres::CauchyLoss(std::sqrt(kTailDegrees)), weight_ * kAtMean, ceres::TAKE_OWNERSHIP),
        unknowns);
}

OtherTerms::OtherTerms(const ScatteringFamily& family, double prior_weight, bool with_energies)
    : at_(unknowns_of(family).lower.size()) {
  problem_.AddParameterBlock(at_.data(), static_cast<int>(at_.size()));
  add_penalties(family, problem_, at_.data(), with_energies);
  if (prior_weight > 0) prior_.emplace(prior_weight);
}

BiasFreeTerms OtherTerms::at(const VectorXd& unknowns) {
  at_ = unknowns;
  BiasFreeTerms terms;
  terms.gradient = VectorXd::Zero(unknowns.size());
  terms.hessian = Eigen::MatrixXd::Zero(unknowns.size(), unknowns.size());
  if (problem_.NumResiduals() > 0) {
    std::vector<double> gradient;
    problem_.Evaluate({}, &terms.loss, nullptr, &gradient, nullptr);
    terms.gradient = Eigen::Map<const VectorXd>(gradient.data(), unknowns.size());
    const Eigen::MatrixXd rows = penalty_jacobian(unknowns);
    terms.hessian = rows.transpose() * rows;
  }
  if (prior_) {
    const BiasFreeTerms prior = prior_->at(unknowns);
    terms.loss += prior.loss;
    terms.gradient += prior.gradient;
    terms.hessian += prior.hessian;
  }
  return terms;
}

Eigen::MatrixXd OtherTerms::penalty_jacobian(const VectorXd& unknowns) {
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

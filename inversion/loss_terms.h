// The loss as terms that Ceres adds up: what the pictures miss, and what does not look at pictures (penalties and prior).
#pragma once

#include <ceres/cost_function.h>
#include <ceres/problem.h>

#include <Eigen/Core>

#include "inversion/bias_free.h"
#include "inversion/scattering_family.h"
#include "inversion/thread_unknowns.h"
#include "inversion/view_objective.h"
#include "renderer/scattering/thread_prior.h"

namespace inversion {

// The pictures' residuals on the objective's recorded paths. `objective` must outlive it.
class DataTerm : public ceres::CostFunction {
 public:
  DataTerm(const ViewObjective& objective, int unknowns);
  bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override;

 private:
  const ViewObjective& objective_;
  int unknowns_;
};

// The simulated threads' mean and covariance as terms of the loss: ||scale (u - mean)||^2 / 2.
class PriorTerm : public ceres::CostFunction {
 public:
  using Rows = Eigen::Matrix<double, renderer::kPriorUnknownCount, renderer::kThreadParameterCount, Eigen::RowMajor>;

  explicit PriorTerm(double weight);  // of the prior's chi square in the loss
  const Rows& jacobian() const { return jacobian_; }
  double loss(const Eigen::VectorXd& unknowns) const;
  bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override;

 private:
  Rows jacobian_;
  ThreadUnknowns mean_;
};

// The family's penalties, and the prior unless its weight is 0.
class OtherTerms {
 public:
  OtherTerms(const ScatteringFamily& family, double prior_weight);
  // As they are at the unknowns, with the Gauss-Newton approximation of the Hessian.
  BiasFreeTerms at(const Eigen::VectorXd& unknowns);
  // Terms x unknowns; no rows where there are no terms.
  Eigen::MatrixXd jacobian(const Eigen::VectorXd& unknowns);

 private:
  Eigen::VectorXd at_;
  ceres::Problem problem_;
};

}  // namespace inversion

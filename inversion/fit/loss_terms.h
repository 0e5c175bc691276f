// The loss as terms that Ceres adds up: the pictures' residuals, and what does not look at pictures (penalties and
// prior).
#pragma once

#include <ceres/cost_function.h>
#include <ceres/problem.h>

#include <Eigen/Core>

#include "inversion/fit/scattering_family.h"
#include "inversion/fit/thread_unknowns.h"
#include "inversion/fit/view_objective.h"
#include "inversion/solve/bias_free.h"
#include "renderer/scattering/thread_prior.h"

namespace inversion {

// The pictures' residuals on the objective's recorded paths. `objective` must outlive the term.
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

  explicit PriorTerm(double weight);  // factor of the prior's chi square in the loss
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
  // The terms at the unknowns, with the Gauss-Newton approximation of the Hessian.
  BiasFreeTerms at(const Eigen::VectorXd& unknowns);
  // The terms' jacobian, terms x unknowns; without rows where there are no terms.
  Eigen::MatrixXd jacobian(const Eigen::VectorXd& unknowns);

 private:
  Eigen::VectorXd at_;
  ceres::Problem problem_;
};

}  // namespace inversion

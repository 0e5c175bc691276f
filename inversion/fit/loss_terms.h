// The loss as terms that Ceres adds up: the pictures' residuals, and what does not look at pictures (penalties and
// prior).
#pragma once

#include <ceres/cost_function.h>
#include <ceres/problem.h>

#include <Eigen/Core>
#include <optional>

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

// What simulated threads have in common as a term of the loss: their mean and covariance, as a density with the heavy
// tails of Student's t [Lange 1989] in each of
//
//   weight (nu + 1) / 2 sum over k of log(1 + z_k^2 / nu),    z = L^-1 (u - mean),    L L' = covariance,    nu = 4
//
// By the triangular L, z_k is how unusual an unknown is given those before it. Near the mean this is the Gaussian's
// z' z / 2. Threads are unlike the simulated ones in a few respects (those of station/data in w2 and n2 given the
// rest, by 3 to 8 deviations, and in one or two others): there they are let go, and held elsewhere.
class ThreadPriorTerm {
 public:
  using Rows = Eigen::Matrix<double, renderer::kPriorUnknownCount, renderer::kThreadParameterCount, Eigen::RowMajor>;

  explicit ThreadPriorTerm(double weight);
  double loss(const Eigen::VectorXd& unknowns) const;
  // The term and its gradient; its Hessian is that of the quadratic that touches it there and is nowhere below it.
  BiasFreeTerms at(const Eigen::VectorXd& unknowns) const;
  // What the term tells: rows' rows is its own Hessian where that is positive. Where a thread is unlike the simulated
  // ones it learns nothing from them.
  Rows known_rows(const Eigen::VectorXd& unknowns) const;
  void add_to(ceres::Problem& problem, double* unknowns) const;

 private:
  using Whitened = Eigen::Matrix<double, renderer::kPriorUnknownCount, 1>;
  Whitened whitened(const Eigen::VectorXd& unknowns) const { return whitening_ * (unknowns - mean_); }
  Whitened weights(const Whitened& z) const;  // of z_k^2 / 2 each

  double weight_;
  Rows whitening_;  // z by u
  ThreadUnknowns mean_;
};

// The family's penalties, and the prior unless its weight is 0.
class OtherTerms {
 public:
  // with_energies: what threads pay for energies beyond 1 (energy_limits) is among them.
  OtherTerms(const ScatteringFamily& family, double prior_weight, bool with_energies = true);
  // The terms at the unknowns, with the Gauss-Newton approximation of the Hessian.
  BiasFreeTerms at(const Eigen::VectorXd& unknowns);
  // The penalties' jacobian, terms x unknowns; without rows where there are none.
  Eigen::MatrixXd penalty_jacobian(const Eigen::VectorXd& unknowns);

 private:
  Eigen::VectorXd at_;
  ceres::Problem problem_;  // of the penalties
  std::optional<ThreadPriorTerm> prior_;
};

}  // namespace inversion

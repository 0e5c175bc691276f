// The loss without bias (bias_free.h) from two halves of the light paths: its terms, and their mean over several sets
// of paths, by which the certainty of a fit is found.
#pragma once

#include <Eigen/Core>

#include "inversion/fit/view_objective.h"
#include "inversion/solve/bias_free.h"

namespace inversion {

// The data's part of the loss, r_A' r_B / 2.
BiasFreeTerms data_terms(const ViewObjective::Halves& both);

// J' J of all paths together, unknowns x unknowns: positive, and larger than the Hessian of data_terms by the noise of
// J, so that steps by it are on average too short, but none is long because noise has left a direction flat.
Eigen::MatrixXd whole_hessian(const ViewObjective::Halves& both);

// The covariance of the gradient J' r of all paths, as their blocks' parts scatter (MeanTerms::gradient_covariance).
Eigen::MatrixXd gradient_covariance(const Eigen::MatrixXd& jacobian, const Eigen::VectorXd& residuals);

// Multiplies residuals and rows of the Jacobians by these factors.
void scale_rows(ViewObjective::Halves& both, const Eigen::VectorXd& factors);

// The mean of several sets' terms, kept block by block, because the three colours of a block share their paths while
// blocks err independently of each other.
class MeanTerms {
 public:
  // Terms of a set of paths whose noise is independent of the others', traced at these unknowns. The sets before count
  // `old` times what they did, as in the mean that the steps go by (BiasFreeOptions::old).
  void add(const ViewObjective::Halves& both, const Eigen::VectorXd& unknowns, double old = 1);
  bool empty() const { return sets_ == 0; }
  // The mean gradient of data_terms. Like hessian() and gradient_covariance(), it needs at least one set.
  Eigen::VectorXd gradient(const Eigen::VectorXd& unknowns) const;
  Eigen::MatrixXd hessian() const;  // unknowns x unknowns
  // The covariance of the mean gradient: the sum over blocks of g g', g being a block's part of it. The noise of the
  // photographs and the misfit are the same in all sets and count in full; the paths' noise is less by their number.
  Eigen::MatrixXd gradient_covariance(const Eigen::VectorXd& unknowns) const;

 private:
  Eigen::MatrixXd block_gradients(const Eigen::VectorXd& unknowns) const;  // unknowns x blocks

  double sets_ = 0;
  Eigen::MatrixXd offsets_;  // unknowns x blocks: sums of gradients, each of the set's quadratic model at unknowns of 0
  Eigen::MatrixXd hessians_;  // (unknowns * unknowns) x blocks: their sums
};

}  // namespace inversion

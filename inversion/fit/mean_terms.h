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

class MeanTerms {
 public:
  // Terms of a set of paths whose noise is independent of the others', traced at these unknowns, near theirs.
  void add(const ViewObjective::Halves& both, const Eigen::VectorXd& unknowns);
  bool empty() const { return sets_ == 0; }
  // The mean gradient of data_terms. Like hessian() and gradient_covariance(), it needs at least one set.
  Eigen::VectorXd gradient(const Eigen::VectorXd& unknowns) const { return (offsets_ + hessians_ * unknowns) / sets_; }
  Eigen::MatrixXd hessian() const { return hessians_ / sets_; }  // unknowns x unknowns
  // The covariance that the noise of pictures and paths gives the gradient of one set, summed over blocks, because the
  // three colours of a block share their paths. The paths' noise is less in the mean of the sets, where steps come to
  // its minimum; along valleys they do not, and there the deviations of fifty fits are as large as this says
  // (measured.md).
  Eigen::MatrixXd gradient_covariance() const { return covariances_ / sets_; }

 private:
  int sets_ = 0;
  Eigen::VectorXd offsets_;                 // sum of gradients, each of the set's quadratic model at unknowns of 0
  Eigen::MatrixXd hessians_, covariances_;  // their sums
};

}  // namespace inversion

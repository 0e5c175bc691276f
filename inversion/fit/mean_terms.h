// The loss without bias (bias_free.h) from two halves of the light paths: its terms, and their mean over several sets
// of paths, by which the certainty of a fit is found.
#pragma once

#include <Eigen/Core>

#include "inversion/fit/view_objective.h"
#include "inversion/solve/bias_free.h"

namespace inversion {

// The data's part of the loss, r_A' r_B / 2.
BiasFreeTerms data_terms(const ViewObjective::Halves& both);

class MeanTerms {
 public:
  // Terms of a set of paths whose noise is independent of the others', traced at unknowns near theirs.
  void add(const ViewObjective::Halves& both);
  bool empty() const { return sets_ == 0; }
  // Unknowns x unknowns, of data_terms; needs one set at least, as does the next.
  Eigen::MatrixXd hessian() const { return hessians_ / sets_; }
  // The covariance that the noise of pictures and paths gives the gradient of one set, summed over blocks, because the
  // three colours of a block share their paths. The paths' noise is less in the mean of the sets, where steps come to
  // its minimum; along valleys they do not, and there the deviations of fifty fits are as large as this says
  // (measured.md).
  Eigen::MatrixXd gradient_covariance() const { return covariances_ / sets_; }

 private:
  int sets_ = 0;
  Eigen::MatrixXd hessians_, covariances_;  // their sums
};

}  // namespace inversion

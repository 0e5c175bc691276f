// The squared residuals of estimated pictures without the bias of their noise, from several sets of light paths of two
// halves each. Set k, traced at x_k, says of the residuals at x that they are about
//
//   r_k(x) = r_k(x_k) + J_k (x - x_k),    by its halves a_k(x) and b_k(x) with r_k = (a_k + b_k) / 2
//
// with errors in residuals and Jacobians that are independent of those of all other halves. The square of the sets'
// mean contains the mean's variance, which the halves' differences tell:
//
//   L(x) = |sum_k w_k r_k(x)|^2 / 2 - sum_k w_k^2 |a_k(x) - b_k(x)|^2 / 8    over    (sum_k w_k)^2
//
// has the misfit of the mean alone for its mean. Of one set that is a' b / 2. Gradient and Hessian are those of L.
// Where unknowns make up for each other J v is nearly 0 along them, and the noise of J decides how well their sum is
// told: in the mean of each set's own a' b it falls with the root of the number of sets, in L with the number itself
// (JoinedSetsTest). Products over all pairs of halves would do so too, but take for noise, and so reward, that sets
// traced at other places disagree.
#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "inversion/solve/bias_free.h"

namespace inversion {

class JoinedSets {
 public:
  // One set's halves: residuals, and their jacobians (residuals x unknowns), traced at these unknowns. The sets before
  // count `old` times what they did.
  void add(const std::array<Eigen::VectorXd, 2>& residuals, const std::array<Eigen::MatrixXd, 2>& jacobians,
           const Eigen::VectorXd& unknowns, double old = 1);
  bool empty() const { return weights_ == 0; }
  // L and its derivatives. Like all that follows it needs at least one set.
  BiasFreeTerms at(const Eigen::VectorXd& unknowns) const;
  // Each residual's part of the gradient, unknowns x residuals.
  Eigen::MatrixXd gradients(const Eigen::VectorXd& unknowns) const;
  Eigen::MatrixXd hessian() const;
  // The standard deviation of the Hessian's curvature v' H v along a direction, which noise leaves it.
  double curvature_deviation(const Eigen::VectorXd& direction) const;
  // What misfit adds to the gradient's covariance if each group of residuals errs as a whole: the sum of v s s' over
  // the groups, s being the sum of their J's rows and v the mean square of their residuals beyond `variances`, which
  // all sets share (photographs' noise), and beyond the paths' noise, which is not in s s' either, so that the sum need
  // not be positive. groups: the number of each residual's group, from 0.
  Eigen::MatrixXd misfit_covariance(const Eigen::VectorXd& unknowns, const std::vector<int>& groups,
                                    const Eigen::VectorXd& variances) const;
  // J' J of the sets' mean: positive, and larger than the Hessian by the noise of J, so that steps by it are on average
  // too short, but none is long because noise has left a direction flat.
  Eigen::MatrixXd whole_hessian() const;
  // The variance of the sets' mean by that of one.
  double variance_of_mean() const { return squares_ / (weights_ * weights_); }

 private:
  double weights_ = 0, squares_ = 0;  // sums of w_k and w_k^2
  Eigen::MatrixXd sums_;              // (unknowns + 1) x residuals: sums of w_k (J_k, r_k(0))
  Eigen::MatrixXd noise_;             // (unknowns + 1)^2 x residuals: the same numbers' covariance
};

}  // namespace inversion

// The covariance of a gradient, from the parts that blocks of pixels have in it: the three colours of a block share
// their light paths, while blocks err independently of each other.
#pragma once

#include <Eigen/Core>

namespace inversion {

// By what residuals have in the gradient, unknowns x residuals, block after block: the sum over blocks of g g', g being
// a block's part. The noise of the photographs and the misfit are the same in all sets of paths and count in full; the
// paths' noise is less by their number.
Eigen::MatrixXd block_covariance(const Eigen::MatrixXd& gradients);

}  // namespace inversion

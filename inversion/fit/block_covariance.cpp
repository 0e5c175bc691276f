#include "inversion/fit/block_covariance.h"

namespace inversion {

using Eigen::MatrixXd;

MatrixXd block_covariance(const MatrixXd& gradients) {
  constexpr Eigen::Index kColours = 3;  // residuals of a block
  MatrixXd parts(gradients.rows(), gradients.cols() / kColours);
  for (Eigen::Index block = 0; block < parts.cols(); ++block)
    parts.col(block) = gradients.middleCols<kColours>(kColours * block).rowwise().sum();
  // Parts scatter less than their noise, because as many unknowns have been fitted to it; the factor is that of
  // [Cameron and Miller 2015] for clusters.
  const auto blocks = static_cast<double>(parts.cols()), rows = kColours * blocks,
             unknowns = static_cast<double>(parts.rows());
  const double factor = rows > unknowns && blocks > 1 ? blocks / (blocks - 1) * (rows - 1) / (rows - unknowns) : 1;
  return factor * parts * parts.transpose();
}

}  // namespace inversion

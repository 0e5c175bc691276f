#include "inversion/fit/mean_terms.h"

namespace inversion {

using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

constexpr Eigen::Index kColours = 3;  // rows of a block

// The covariance of a gradient, unknowns x blocks of parts that err independently. They scatter less than their noise,
// because as many unknowns have been fitted to it; the factor is that of [Cameron and Miller 2015] for clusters.
MatrixXd covariance_by(const MatrixXd& parts) {
  const auto blocks = static_cast<double>(parts.cols()), rows = kColours * blocks,
             unknowns = static_cast<double>(parts.rows());
  const double factor = rows > unknowns && blocks > 1 ? blocks / (blocks - 1) * (rows - 1) / (rows - unknowns) : 1;
  return factor * parts * parts.transpose();
}

}  // namespace

BiasFreeTerms data_terms(const ViewObjective::Halves& both) {
  const auto& [a, b] = both.residuals;
  const auto& [by_a, by_b] = both.jacobians;
  const MatrixXd product = by_a.transpose() * by_b;
  return {.loss = 0.5 * a.dot(b),
          .gradient = 0.5 * (by_a.transpose() * b + by_b.transpose() * a),
          .hessian = 0.5 * (product + product.transpose())};
}

MatrixXd whole_hessian(const ViewObjective::Halves& both) {
  const MatrixXd by = 0.5 * (both.jacobians[0] + both.jacobians[1]);
  return by.transpose() * by;
}

MatrixXd gradient_covariance(const MatrixXd& jacobian, const VectorXd& residuals) {
  MatrixXd gradients(jacobian.cols(), jacobian.rows() / kColours);
  for (Eigen::Index block = 0; block < gradients.cols(); ++block)
    gradients.col(block) =
        jacobian.middleRows<kColours>(kColours * block).transpose() * residuals.segment<kColours>(kColours * block);
  return covariance_by(gradients);
}

void scale_rows(ViewObjective::Halves& both, const VectorXd& factors) {
  for (VectorXd& residuals : both.residuals) residuals.array() *= factors.array();
  for (MatrixXd& jacobian : both.jacobians) jacobian.array().colwise() *= factors.array();
}

void MeanTerms::add(const ViewObjective::Halves& both, const VectorXd& unknowns, double old) {
  const auto& [a, b] = both.residuals;
  const auto& [by_a, by_b] = both.jacobians;
  const Eigen::Index count = by_a.cols(), blocks = by_a.rows() / kColours;
  if (empty()) {
    offsets_ = MatrixXd::Zero(count, blocks);
    hessians_ = MatrixXd::Zero(count * count, blocks);
  }
  sets_ = old * sets_ + 1;
  offsets_ *= old;
  hessians_ *= old;
  for (Eigen::Index block = 0; block < blocks; ++block) {
    const auto rows_a = by_a.middleRows<kColours>(kColours * block),
               rows_b = by_b.middleRows<kColours>(kColours * block);
    const MatrixXd product = rows_a.transpose() * rows_b, hessian = 0.5 * (product + product.transpose());
    offsets_.col(block) += 0.5 * (rows_a.transpose() * b.segment<kColours>(kColours * block) +
                                  rows_b.transpose() * a.segment<kColours>(kColours * block)) -
                           hessian * unknowns;
    hessians_.col(block) += hessian.reshaped();
  }
}

MatrixXd MeanTerms::block_gradients(const VectorXd& unknowns) const {
  MatrixXd gradients = offsets_;
  for (Eigen::Index block = 0; block < gradients.cols(); ++block)
    gradients.col(block) += hessians_.col(block).reshaped(unknowns.size(), unknowns.size()) * unknowns;
  return gradients / sets_;
}

VectorXd MeanTerms::gradient(const VectorXd& unknowns) const {
  return block_gradients(unknowns).rowwise().sum();
}

MatrixXd MeanTerms::hessian() const {
  const Eigen::Index count = offsets_.rows();
  return hessians_.rowwise().sum().reshaped(count, count) / sets_;
}

MatrixXd MeanTerms::gradient_covariance(const VectorXd& unknowns) const {
  return covariance_by(block_gradients(unknowns));
}

}  // namespace inversion

#include "inversion/fit/mean_terms.h"

namespace inversion {

using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

constexpr Eigen::Index kColours = 3;  // rows of a block

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

void MeanTerms::add(const ViewObjective::Halves& both, const VectorXd& unknowns) {
  const auto& [a, b] = both.residuals;
  const auto& [by_a, by_b] = both.jacobians;
  if (empty()) {
    offsets_ = VectorXd::Zero(by_a.cols());
    hessians_ = covariances_ = MatrixXd::Zero(by_a.cols(), by_a.cols());
  }
  const BiasFreeTerms terms = data_terms(both);
  offsets_ += terms.gradient - terms.hessian * unknowns;
  hessians_ += terms.hessian;
  for (Eigen::Index row = 0; row < a.size(); row += kColours) {
    const VectorXd of_block = 0.5 * (by_a.middleRows<kColours>(row).transpose() * b.segment<kColours>(row) +
                                     by_b.middleRows<kColours>(row).transpose() * a.segment<kColours>(row));
    covariances_ += of_block * of_block.transpose();
  }
  ++sets_;
}

}  // namespace inversion

#include "inversion/fit/step_coordinates.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "renderer/scattering/width_slopes.h"

namespace inversion {
namespace {

using Eigen::VectorXd;
using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

// Of log s: near beta = 0.5 the coordinate changes as fast as beta.
constexpr double kLogScale = 1.0 / 3;

// The roughness whose lobe has this width, by Newton's method in the logarithm of both, in which s is nearly a power
// of beta, twice.
double roughness_of(double log_scale) {
  double log_beta = std::min(0.0, 0.5 * log_scale);
  for (int i = 0; i < 60; ++i) {
    const double beta = std::exp(log_beta), scale = renderer::azimuthal_scale(beta);
    const double step = (log_scale - std::log(scale)) * scale / (beta * renderer::azimuthal_scale_slope(beta));
    log_beta += step;
    if (std::abs(step) < 1e-14) break;
  }
  return std::exp(log_beta);
}

}  // namespace

StepCoordinates::StepCoordinates(const FamilyUnknowns& family)
    : azimuthal_(family.azimuthal_roughnesses), lower_(family.lower), upper_(family.upper) {}

VectorXd StepCoordinates::of(const VectorXd& unknowns) const {
  VectorXd coordinates = unknowns;
  for (int k : azimuthal_) coordinates[k] = kLogScale * std::log(renderer::azimuthal_scale(unknowns[k]));
  return coordinates;
}

VectorXd StepCoordinates::unknowns(const VectorXd& coordinates) const {
  VectorXd unknowns = coordinates;
  for (int k : azimuthal_) unknowns[k] = roughness_of(coordinates[k] / kLogScale);
  return unknowns.cwiseMax(lower_).cwiseMin(upper_);
}

VectorXd StepCoordinates::slopes(const VectorXd& unknowns) const {
  VectorXd slopes = VectorXd::Ones(unknowns.size());
  for (int k : azimuthal_)
    slopes[k] = renderer::azimuthal_scale(unknowns[k]) / (kLogScale * renderer::azimuthal_scale_slope(unknowns[k]));
  return slopes;
}

BiasFreeTerms StepCoordinates::of(BiasFreeTerms terms, const VectorXd& unknowns) const {
  const VectorXd by = slopes(unknowns);
  terms.gradient = by.cwiseProduct(terms.gradient);
  terms.hessian = by.asDiagonal() * terms.hessian * by.asDiagonal();
  return terms;
}

StepManifold::StepManifold(const StepCoordinates& coordinates, int unknowns, const std::vector<int>& held)
    : coordinates_(coordinates), unknowns_(unknowns) {
  for (int k = 0; k < unknowns; ++k)
    if (std::find(held.begin(), held.end(), k) == held.end()) free_.push_back(k);
}

bool StepManifold::Plus(const double* at, const double* step, double* there) const {
  VectorXd coordinates = coordinates_.of(Eigen::Map<const VectorXd>(at, unknowns_));
  for (std::size_t i = 0; i < free_.size(); ++i) coordinates[free_[i]] += step[i];
  Eigen::Map<VectorXd> to(there, unknowns_);
  to = Eigen::Map<const VectorXd>(at, unknowns_);
  const VectorXd stepped = coordinates_.unknowns(coordinates);
  for (std::size_t i = 0; i < free_.size(); ++i)
    if (step[i] != 0) to[free_[i]] = stepped[free_[i]];
  return true;
}

bool StepManifold::PlusJacobian(const double* at, double* jacobian) const {
  const VectorXd slopes = coordinates_.slopes(Eigen::Map<const VectorXd>(at, unknowns_));
  Eigen::Map<RowMajor> rows(jacobian, unknowns_, TangentSize());
  rows.setZero();
  for (std::size_t i = 0; i < free_.size(); ++i) rows(free_[i], static_cast<Eigen::Index>(i)) = slopes[free_[i]];
  return true;
}

bool StepManifold::Minus(const double* there, const double* at, double* step) const {
  const VectorXd change = coordinates_.of(Eigen::Map<const VectorXd>(there, unknowns_)) -
                          coordinates_.of(Eigen::Map<const VectorXd>(at, unknowns_));
  for (std::size_t i = 0; i < free_.size(); ++i) step[i] = change[free_[i]];
  return true;
}

bool StepManifold::MinusJacobian(const double* at, double* jacobian) const {
  const VectorXd slopes = coordinates_.slopes(Eigen::Map<const VectorXd>(at, unknowns_));
  Eigen::Map<RowMajor> rows(jacobian, TangentSize(), unknowns_);
  rows.setZero();
  for (std::size_t i = 0; i < free_.size(); ++i) rows(static_cast<Eigen::Index>(i), free_[i]) = 1 / slopes[free_[i]];
  return true;
}

}  // namespace inversion

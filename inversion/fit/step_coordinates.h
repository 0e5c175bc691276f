// The coordinates in which solvers step: the unknowns, but for azimuthal roughnesses beta a multiple of log s(beta),
// the logarithm of their lobe's width [Chiang 2015]. s rises with beta's power 22: at 0.9 the loss is twenty times as
// curved in beta as at 0.55, steps from there are as much too short, and wide lobes stayed wide. In log s it is curved
// about evenly.
#pragma once

#include <ceres/manifold.h>

#include <Eigen/Core>
#include <vector>

#include "inversion/fit/scattering_family.h"
#include "inversion/solve/bias_free.h"

namespace inversion {

class StepCoordinates {
 public:
  explicit StepCoordinates(const FamilyUnknowns& family);

  Eigen::VectorXd of(const Eigen::VectorXd& unknowns) const;
  // Within the bounds of the unknowns.
  Eigen::VectorXd unknowns(const Eigen::VectorXd& coordinates) const;
  Eigen::VectorXd slopes(const Eigen::VectorXd& unknowns) const;  // d unknown / d its coordinate
  // Terms by the unknowns as terms by the coordinates, with the Gauss-Newton approximation of the Hessian.
  BiasFreeTerms of(BiasFreeTerms terms, const Eigen::VectorXd& unknowns) const;

 private:
  std::vector<int> azimuthal_;
  Eigen::VectorXd lower_, upper_;
};

// Ceres' steps in these coordinates, of the unknowns that are not held.
class StepManifold : public ceres::Manifold {
 public:
  StepManifold(const StepCoordinates& coordinates, int unknowns, const std::vector<int>& held);

  int AmbientSize() const override { return unknowns_; }
  int TangentSize() const override { return static_cast<int>(free_.size()); }
  bool Plus(const double* at, const double* step, double* there) const override;
  bool PlusJacobian(const double* at, double* jacobian) const override;
  bool Minus(const double* there, const double* at, double* step) const override;
  bool MinusJacobian(const double* at, double* jacobian) const override;

 private:
  StepCoordinates coordinates_;
  int unknowns_;
  std::vector<int> free_;
};

}  // namespace inversion

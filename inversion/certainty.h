// How well a fit knows its unknowns: the covariance of a least-squares estimate whose residuals have other variances than
// its weights say,
//
//   C = H^-1 G H^-1,    H = J' J + the other terms' part
//
// (White 1980). G is the covariance of the gradient: the sum of g_b g_b' over blocks b of pixels, whose noise is independent,
// with g_b the block's part of the gradient as the fit forms it. So it has the photographs' noise and that of the light
// paths - the three colours of a block share them, and J is as noisy as the residuals -, which J' S J of residuals with
// variances S does not. Where the model cannot explain a block, its misfit counts in G as noise. The total has besides what the model cannot
// explain - a view's mean squared residual beyond its noise, taken as common to all its blocks, because misfit is smooth
// over a view -, the prior's own uncertainty, and for directions that nothing speaks of a deviation of 1 in the scales.
#pragma once

#include <Eigen/Core>
#include <vector>

namespace inversion {

struct Certainty {
  Eigen::MatrixXd noise_covariance;  // unknowns x unknowns; what other noise would change
  Eigen::MatrixXd covariance;        // with misfit
  std::vector<bool> at_bound;        // or held: not varied, no variance
  // Directions that the views determine worst: unit in units of each unknown's standard deviation scale (see scales),
  // with the standard deviation along them. Worst first.
  struct Direction {
    Eigen::VectorXd direction;
    double sigma;
  };
  std::vector<Direction> weakest;
  double misfit =
      0;  // root mean square of the residuals over that of their noise: 1 where the model explains the views
};

struct LinearisedFit {
  Eigen::MatrixXd jacobian;  // residuals x unknowns
  Eigen::MatrixXd hessian;   // of the data: J' J unless the noise of J itself was taken out; may be empty: J' J
  Eigen::MatrixXd gradient_covariance;  // G; may be empty: J' S J
  Eigen::VectorXd residuals, variances;
  std::vector<int> views;            // of each residual, from 0
  Eigen::MatrixXd penalty_jacobian;  // penalties x unknowns; may have no rows
  Eigen::MatrixXd
      prior_jacobian;       // the prior's terms, each of the residuals' mean square as its variance; may be empty
  std::vector<bool> fixed;  // unknowns that are held or at a bound
  Eigen::VectorXd scales;   // of the unknowns: what counts as a large change
};

Certainty certainty_of(const LinearisedFit& fit);

}  // namespace inversion

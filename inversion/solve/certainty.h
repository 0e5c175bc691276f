// The certainty of a fit's unknowns: the covariance of a least-squares estimate whose residuals have other variances
// than its weights say,
//
//   C = H^-1 G H^-1,    H = J' J + the other terms' part
//
// (White 1980). G is the covariance of the gradient: the sum of g_b g_b' over blocks b of pixels, whose noise is
// independent, with g_b the block's part of the gradient as the fit forms it. So G contains the photographs' noise and
// that of the light paths. J' S J of residuals with variances S would not contain the latter in full, because the three
// colours of a block share the paths and J is as noisy as the residuals. Where the model cannot explain a block, its
// misfit counts in G as noise.
//
// Steps that damp directions which the data hardly tell do not go all the way to the minimum. Where a gradient greater
// by one moves their end by K, and they leave L of what separates the minimum from their start, whose covariance is
// C_0, the spread is K G K' + L C_0 L'. The total is that of the minimum.
//
// The total covariance contains besides: what the model cannot explain (JoinedSets::misfit_covariance), the prior's own
// uncertainty, and a deviation of 1 in the scales for directions that nothing speaks of.
//
// At a bound the truth lies on one side. What the unknown's distance t from its bound may be follows a normal density
// around the minimum that the loss would have without the bound, cut off there; its deviation is the root of E[t^2].
// A minimum more than three deviations beyond counts as three: as the truth lies on this side, it says that the
// deviation is too small rather than that the unknown is known so much better.
// Every other unknown moves along with it on the valley's floor, by B = -H_ff^-1 H_fb, and is uncertain by B t besides
// what it is while the bound holds. Each unknown at a bound is treated as if it were the only one. That is the total;
// other noise would move that minimum, around a truth on this side of the bound, and what the fit then finds is cut off
// there: the spread is taken to be that around a truth at the bound, however far beyond it this one minimum lies.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <vector>

namespace inversion {

struct Certainty {
  Eigen::MatrixXd noise_covariance;  // unknowns x unknowns; the spread that other noise would give
  Eigen::MatrixXd covariance;        // the total, with misfit
  std::vector<bool> at_bound;        // their deviation is one-sided
  // How far beyond its bound an unknown would end without it, in deviations; 0: inside, or not known.
  Eigen::VectorXd beyond_bound;
  // The directions that the views determine worst, worst first: unit vectors in units of the unknowns' scales
  // (LinearisedFit::scales), with the standard deviation along them.
  struct Direction {
    Eigen::VectorXd direction;
    double sigma;
  };
  std::vector<Direction> weakest;
  double misfit = 0;  // root mean square of the residuals over that of their noise; 1: the model explains the views
};

struct LinearisedFit {
  Eigen::MatrixXd jacobian;  // residuals x unknowns
  Eigen::MatrixXd hessian;   // of the data, without the noise of J itself; may be empty: J' J
  // How far noise leaves the data's Hessian uncertain along a direction, of the unknowns. Curvatures that it hides
  // count as large as it. May be empty: not at all.
  std::function<double(const Eigen::VectorXd& direction)> curvature_deviation{};
  Eigen::MatrixXd gradient_covariance;  // G; may be empty: J' S J
  // What the views' misfit adds to G in the total; may be empty, and need not be positive.
  Eigen::MatrixXd misfit_covariance;
  Eigen::VectorXd residuals, variances;
  // Of a residual in the loss that was minimised, if that is the mean over more paths than `residuals` are of; 0: the
  // mean square of `residuals`.
  double mean_variance = 0;
  Eigen::MatrixXd gain, left, start_covariance;  // K, L and C_0; may be empty: H^-1, 0 and 0
  double damping = 0;                            // of the last step, for the spread of what is at a bound
  Eigen::MatrixXd penalty_jacobian;              // penalties x unknowns; may have no rows
  Eigen::MatrixXd prior_jacobian;                // the prior's terms, of variance `mean_variance`; may be empty
  std::vector<bool> held;                        // unknowns that were not varied: no variance
  // -1: at its lower bound, 1: at its upper one, 0: neither.
  std::vector<int> bounds;
  // The gradient of the whole loss at the end of the fit. It may be empty: unknowns at a bound then count as if the
  // loss were level there, which gives them the largest deviation.
  Eigen::VectorXd gradient;
  Eigen::VectorXd scales;  // what counts as a large change of each unknown
};

// The certainty of the unknowns of a fit that was linearised at its end.
Certainty certainty_of(const LinearisedFit& fit);

}  // namespace inversion

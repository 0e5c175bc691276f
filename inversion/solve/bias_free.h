// Least squares without the bias of estimated pictures: the minimisation of
//
//   L = r_A' r_B / 2 + other terms
//
// where r_A and r_B are the residuals from two independent sets of light paths. The sum of squares of one set contains,
// besides the misfit, the set's own variance, and so prefers parameters whose pictures are estimated with little noise,
// wider lobes above all: the thread of the tests came out with beta_R 0.59 instead of 0.35 at 2048 paths a block. Here
// E[L] is the misfit alone.
//
// Recorded paths estimate parameters that they were not traced with ever more noisily, and there L of a fixed set falls
// below zero (measured: beta_R 0.06). So every step has paths of its own, traced at the unknowns that it starts from.
// The steps are Newton steps whose Hessian is (J_A' J_B + J_B' J_A) / 2, made positive. The first ones go by the paths
// of their own, with the Hessians of the steps before in a running mean. From then on all sets of paths count together:
// the next place is the minimum of the mean of their quadratic models,
//
//   L_k + g_k' (x - x_k) + (x - x_k)' H_k (x - x_k) / 2   of the set k traced at x_k,
//
// so that their noise averages out in gradient and Hessian alike. (Steps of 1/2, 1/3 ... by one set each [Robbins and
// Monro 1951] average the gradient alone: measured.md compares.) Unknowns are kept within bounds by holding those that
// a step would take outside.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <vector>

namespace inversion {

struct BiasFreeTerms {
  double loss = 0;
  Eigen::VectorXd gradient;
  Eigen::MatrixXd hessian;  // approximate, symmetric; need not be positive
};
// The part of the loss that paths estimate. Traces new ones at every call.
using BiasFreeLoss = std::function<BiasFreeTerms(int step, const Eigen::VectorXd& unknowns)>;

struct BiasFreeOptions {
  Eigen::VectorXd lower, upper;
  std::vector<int> held{};
  // Terms that no paths estimate, such as penalties and a prior, at any unknowns; may be empty. Every step asks for
  // them where it begins.
  std::function<BiasFreeTerms(const Eigen::VectorXd& unknowns)> exact{};
  int own_steps = 4;     // by paths of their own
  int joint_steps = 6;   // by all paths from the last of those on
  double longest = 0.1;  // largest change of an unknown in one step
};

// Minimises the loss, with its exact terms, from `unknowns` on; returns the losses met on the way, one a step. Throws
// what `loss` throws.
std::vector<double> minimise_bias_free(const BiasFreeLoss& loss, const BiasFreeOptions& options,
                                       Eigen::VectorXd& unknowns);

}  // namespace inversion

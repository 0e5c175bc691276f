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
// The next place is the minimum of the quadratic L that all sets so far make together (joined_sets.h), so that their
// noise averages out in gradient and Hessian alike, with the Hessian made positive. (Steps of 1/2, 1/3 ... by one set
// each [Robbins and Monro 1951] average the gradient alone: measured.md compares.) On the approach each set counts half
// of the next one, as models of far places are wrong here; in the joint steps behind it all sets count alike.
//
// No unknown moves by more than `longest` in a step, and what the others do is solved with it there; bounds are kept
// likewise. Directions that one set tells to no better than `reach` are damped: they would wander as far as they are
// uncertain, and lead the others astray.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <vector>

namespace inversion {

struct BiasFreeTerms {
  double loss = 0;
  Eigen::VectorXd gradient;
  Eigen::MatrixXd hessian;  // approximate, symmetric; need not be positive
  double variance = 0;      // of a residual, for `reach`; 0: nothing is damped by it
  // How far noise leaves the Hessian's curvature along a unit vector uncertain; may be empty: not at all. Steps take
  // curvatures that it hides to be as large as it.
  std::function<double(const Eigen::VectorXd& direction)> curvature_deviation{};
};
// The part of the loss that paths estimate. Traces a new set at every call, and answers for all sets together, of which
// those before count `old` times what they did.
using BiasFreeLoss = std::function<BiasFreeTerms(int step, const Eigen::VectorXd& unknowns, double old)>;

struct BiasFreeOptions {
  Eigen::VectorXd lower, upper;
  std::vector<int> held{};
  // Terms that no paths estimate, such as penalties and a prior, at any unknowns; may be empty. Every step asks for
  // them where it begins.
  std::function<BiasFreeTerms(const Eigen::VectorXd& unknowns)> exact{};
  // Half the square of each of these values that is positive is a term too. Steps know that such a wall begins at 0:
  // a quadratic model of it would hold what touches it on both sides. They are asked for where a step begins; may be
  // empty.
  struct Limits {
    Eigen::VectorXd values;
    Eigen::MatrixXd rows;  // values x unknowns: their derivatives
  };
  std::function<Limits(const Eigen::VectorXd& unknowns)> limits{};
  int approach_steps = 8;
  int joint_steps = 12;
  double old = 0.5;      // on the approach, what a set counts of the next one
  double longest = 0.1;  // change of an unknown in one step
  double reach = 0.1;    // deviation of one set, in the unknowns' units, beyond which a direction is damped
};

struct BiasFreeEnd {
  std::vector<double> losses;  // met on the way, one a step
  // Unknowns x unknowns: what damping has left of a deviation of the start, and how far a gradient that is greater by
  // one in all steps moves the end back. Unknowns that are held or end at a bound have none, and leave none in others.
  Eigen::MatrixXd left, gain;
};

// Minimises the loss, with its exact terms, from `unknowns` on. Throws what `loss` throws.
BiasFreeEnd minimise_bias_free(const BiasFreeLoss& loss, const BiasFreeOptions& options, Eigen::VectorXd& unknowns);

}  // namespace inversion

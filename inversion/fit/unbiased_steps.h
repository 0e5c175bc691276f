// The end of a search: steps without the bias of the paths' noise (bias_free.h), whose residuals are weighted by that
// noise (noise_weights.h), and how certain the unknowns then are.
#pragma once

#include <Eigen/Core>
#include <functional>

#include "inversion/fit/search.h"
#include "inversion/fit/view_objective.h"
#include "inversion/solve/joined_sets.h"

namespace inversion {

// What the steps have met.
struct UnbiasedEnd {
  JoinedSets sets{};                   // of paths, by StepCoordinates
  Eigen::VectorXd factors{};           // of the residuals of eq. 6, as in the last of them; empty: 1
  double variance = 0;                 // of the mean residual of all sets, as the steps weigh them
  double prior_scale = 0;              // of ThreadPriorTerm
  Eigen::MatrixXd left{}, gain{};      // BiasFreeEnd, of the unknowns
  double damping = 0;                  // of the last step
  Eigen::MatrixXd start_covariance{};  // of the unknowns
};

// Goes on from the attempt's unknowns, with which the objective's paths have been traced. `first_trace`: the number of
// the first step's paths (seed_of_trace). The prior's chi square counts as much as that of the mean over all sets of
// paths: by the noise of one set it would draw an unusual thread away from what its photographs say. The blocks are
// weighed robustly unless the attempt's rounds have done so. The last step's paths remain recorded. Calls show(step)
// before each, from 0, and passes on what it throws.
UnbiasedEnd remove_bias(ViewObjective& objective, const Search& search, int first_trace,
                        const std::function<void(int)>& show, Attempt& attempt);

// The certainty at the unknowns, by the paths that were recorded last and by what was met on the way there, if
// anything.
Certainty certainty_at(const ViewObjective& objective, const Search& search, double prior_scale,
                       const Eigen::VectorXd& unknowns, UnbiasedEnd end);

// How where Levenberg-Marquardt has just ended would spread over other noise.
Eigen::MatrixXd covariance_of_round(const ViewObjective& objective, const Search& search, const Attempt& attempt);

}  // namespace inversion

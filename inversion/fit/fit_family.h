// The fit of one family's unknowns to views, by the solver that the options name.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "inversion/fit/view_fit.h"
#include "inversion/solve/bias_free.h"
#include "inversion/view/view.h"

namespace inversion {

// How Levenberg-Marquardt goes on: by its rounds, then by steps of bias_free.h.
struct Effort {
  int block_stride = 1;  // ViewObjective
  bool rounds = true;    // false: the steps, if the options allow them, begin at the first start
  bool robust = true;    // false: no robust weights, whatever the options say
  int approach_steps = BiasFreeOptions{}.approach_steps;  // of bias_free.h, as the next
  int joint_steps = BiasFreeOptions{}.joint_steps;
  bool by_whole_hessian = false;  // mean_terms.h
};

// With fewer paths the product of two halves' errors is larger than the bias that those steps are to remove.
inline constexpr int kFewestPathsWithoutBias = 512;

// The fit that goes farthest from `starts`, of which there is at least one; vectors of the family's unknowns. Errors:
// those of fit_views.
ViewFit fit_family(const WrappedSpool& spool, const std::vector<View>& views, const FitOptions& options,
                   const ScatteringFamily& family, const std::vector<Eigen::VectorXd>& starts,
                   const Effort& effort = {});

}  // namespace inversion

// The fit of one family's unknowns to views, by the solver that the options name.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "inversion/fit/effort.h"
#include "inversion/fit/view_fit.h"
#include "inversion/view/view.h"

namespace inversion {

// The fit that goes farthest from `starts`, of which there is at least one; vectors of the family's unknowns. Errors:
// those of fit_views.
ViewFit fit_family(const WrappedSpool& spool, const std::vector<View>& views, const FitOptions& options,
                   const ScatteringFamily& family, const std::vector<Eigen::VectorXd>& starts,
                   const Effort& effort = {});

}  // namespace inversion

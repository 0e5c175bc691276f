// The fit of a bundle, whose number of fibers and packing cannot be changed by a step in its unknowns. Many bundles are
// fitted, and the best are fitted on:
//
//   stage | bundles                                                  | blocks     | compared by paths a block
//   1     | counts at the densest packing, from the middle one as    | every 3rd  | 3 x 1024
//         | far as they get better; all packings of the best and of  |            |
//         | the next larger count                                    |            |
//   2     | the best four                                            | all        | 4 x 1024
//   3     | the best one                                             | all        |
//
// They are compared by how well they explain the views without their own paths' noise (relative_misfit), which is
// larger than what tells 10 fibers from 20. For the same reason every stage ends with steps that are free of it
// (bias_free.h).
#pragma once

#include <vector>

#include "inversion/fit/view_fit.h"
#include "inversion/view/view.h"

namespace inversion {

// The fit, by Levenberg-Marquardt whatever the options say. Errors: those of fit_views.
ViewFit fit_best_bundle(const WrappedSpool& spool, const std::vector<View>& views, const FitOptions& options);

}  // namespace inversion

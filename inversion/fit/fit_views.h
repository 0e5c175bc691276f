// The fit of a scattering model to photographs of a wrapped spool, which minimises the loss of eq. 6 [Xia 2025]
//
//   L = sum over views i of  w_i sum over masked pixels ||I_i - I_ref,i||^2  +  penalties,      w_i = 1 / masked pixels
//
// over block averages (blocks.h), in units of the mean radiance of a perfect diffuser facing the lamp (view.h). The
// pictures I_i are path-traced. Penalties: scattering_family.h, and where the views say little the prior below.
//
//   solver              | light paths                                 | steps
//   levenberg_marquardt | recorded at the parameters known so far and | until the loss settles, in each of a few rounds
//                       | shaded for all others (light_paths.h); each | with more paths; bounds are kept
//                       | round records anew                          |
//   adam                | recorded anew for every step                | 100, rate 0.01 [Xia 2025, section 4], clamped
//
// Eq. 6's hinges that keep energies positive are bounds here (thread_unknowns.h), for both solvers; its trend is
// rounded within a thousandth of its corner.
//
// ModelKind::bundle finds the number of fibers and their packing besides (bundle_search.h), and always by
// Levenberg-Marquardt.
//
// ModelKind::paper is the paper's own recipe, to tell what the model cannot do from what is done differently here:
// single pixels, all of the same weight in a view; the printed parameters with the printed hinges; light leaves where
// it came in; Adam from one start, 100 steps of rate 0.01; no prior, no robust weights. The paper gives neither the
// start nor the number of paths: they are this project's.
#pragma once

#include <vector>

#include "inversion/fit/view_fit.h"
#include "inversion/view/view.h"

namespace inversion {

// The fit of a model to the views; of the yarn model the best of kYarnFiberCounts. Errors: std::runtime_error when the
// views are unusable (none, no masked pixels, dark lamp) or the fit was stopped; std::invalid_argument when there is no
// round or one without paths.
ViewFit fit_views(const WrappedSpool& spool, const std::vector<View>& views, const FitOptions& options);

}  // namespace inversion

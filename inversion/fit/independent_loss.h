// How well a fit explains views, by light paths that it has not seen.
#pragma once

#include <cstdint>
#include <vector>

#include "inversion/fit/view_fit.h"
#include "inversion/view/view.h"

namespace inversion {

// The loss by which two fits are compared: eq. 6's sum over the pictures, without penalties, at the fit's unknowns, on
// light paths that no fit has seen. The paths are recorded `repetitions` >= 2 times.
struct IndependentLoss {
  double mean = 0, standard_error = 0;
  double without_noise = 0;  // by products of residuals of different repetitions: the misfit alone; may be below zero
};
IndependentLoss independent_loss(const WrappedSpool& spool, const std::vector<View>& views, const ViewFit& fit,
                                 int paths_per_block, int repetitions, std::uint64_t seed);

// The mean square of relative residuals (ViewObjective::relative_scales) of every `block_stride`-th block, without the
// paths' noise; may be below zero. Dark views and colours, which hardly count in eq. 6, count here, as their noise is
// less too, so that fewer paths tell models apart.
double relative_misfit(const WrappedSpool& spool, const std::vector<View>& views, const ViewFit& fit,
                       int paths_per_block, int repetitions, std::uint64_t seed, int block_stride);

}  // namespace inversion

// Levenberg-Marquardt, round after round: each records light paths at the unknowns known so far and searches on them
// until the loss settles (fit_views.h).
#pragma once

#include "inversion/fit/search.h"
#include "inversion/fit/view_objective.h"

namespace inversion {

// One round of FitOptions::paths_per_block, from the attempt's unknowns on; its work is its paths. robustly: the blocks
// are weighed there first. Errors: std::runtime_error when no thread was found or the fit was stopped.
void run_round(ViewObjective& objective, const Search& search, int round, bool robustly, Work& work, Attempt& attempt);

}  // namespace inversion

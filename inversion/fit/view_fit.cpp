#include "inversion/fit/view_fit.h"

#include <algorithm>

namespace inversion {

FitOptions first_rounds(FitOptions options, std::size_t rounds) {
  options.solver = Solver::levenberg_marquardt;
  options.other_starts.clear();
  if (rounds < options.paths_per_block.size()) options.paths_per_block.resize(rounds);
  return options;
}

double ViewFit::loss() const {
  const auto last =
      std::find_if(rounds.rbegin(), rounds.rend(), [](const FitRound& round) { return !round.bias_free; });
  return last == rounds.rend() ? rounds.back().loss_after : last->loss_after;
}

}  // namespace inversion

// The choice between the searches of one fit, each from a start of its own.
//
// Before they are compared (misfit_comparison.h) the searches for a thread go on by steps without bias, with every
// third block where there are many: where Levenberg-Marquardt ends says little of where they lead.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "inversion/fit/search.h"

namespace inversion {

struct NearestSearch {
  Attempt nearest;  // its rounds, and how far it has got
  // Of a thread: R and TRT both send light back, and may each have taken the other's place, from where no small step
  // leads back. This is the nearest search gone on with from where both are exchanged, if it stays there; under a tint
  // it is that of another start which lies there, if one does. Only the ends of both tell which is right.
  std::optional<Attempt> exchanged;
};

// The search that gets nearest to the views, which have `blocks` blocks, among one or more. Errors: std::runtime_error
// when the fit was stopped.
NearestSearch nearest_search(const WrappedSpool& spool, const std::vector<View>& views, std::size_t blocks,
                             const Search& search, std::vector<Attempt> attempts, Work& work);

// The work of that, in light paths a block.
double work_of_choice(const Search& search, std::size_t blocks, std::size_t attempts);

}  // namespace inversion

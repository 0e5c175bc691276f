// The choice between the searches of one fit, each from a start of its own.
//
// Their losses of eq. 6 do not tell them apart: those are mostly the noise of their own paths, which is least where
// lobes are wide. So all are compared on paths that none has seen, weighted by noise alike, without bias. Before that
// the searches for a thread go on by steps without bias, with every third block where there are many: where
// Levenberg-Marquardt ends says little of where they lead. And R and TRT both send light back: they may each have taken
// the other's place, from where no small step leads back. So the nearest search goes on once more with both exchanged.
#pragma once

#include <cstddef>
#include <vector>

#include "inversion/fit/search.h"

namespace inversion {

// The search that gets nearest to the views, which have `blocks` blocks, among one or more: its rounds, and how far it
// has got. Errors: std::runtime_error when the fit was stopped.
Attempt nearest_search(const WrappedSpool& spool, const std::vector<View>& views, std::size_t blocks,
                       const Search& search, std::vector<Attempt> attempts, Work& work);

// The work of that, in light paths a block.
double work_of_choice(const Search& search, std::size_t blocks, std::size_t attempts);

}  // namespace inversion

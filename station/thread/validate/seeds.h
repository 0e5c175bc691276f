// Where the random numbers of a study begin, each use apart from the seeds of its photographs and fits.
#pragma once

#include <cstdint>

namespace station {

inline constexpr std::uint64_t kExactViewSeeds = 5000;         // added to the fit's: pictures of the known thread
inline constexpr std::uint64_t kFittedViewSeeds = 7000;        // pictures of the fits, beside the photographs
inline constexpr std::uint64_t kIndependentLossSeeds = 77777;  // added to the fit's: paths that no fit has seen

}  // namespace station

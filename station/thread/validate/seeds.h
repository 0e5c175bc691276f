// Where the random numbers of a study begin, each use apart from the seeds of its photographs and fits.
#pragma once

#include <cstdint>

namespace station {

inline constexpr std::uint64_t kExactViewSeeds = 5000;         // added to the fit's: pictures of the known thread
inline constexpr std::uint64_t kFittedViewSeeds = 7000;        // pictures of the fits, beside the photographs
inline constexpr std::uint64_t kIndependentLossSeeds = 77777;  // added to the fit's: paths that no fit has seen
inline constexpr std::uint64_t kDrawSeedStep = 100000;         // between the fits of two draws of the noise
inline constexpr std::uint64_t kFoldSeedStep = 100;            // between the pictures of two folds
inline constexpr std::uint64_t kPictureSeeds = 1000;           // a study's pictures begin at its seed times this
inline constexpr std::uint64_t kPlacedAnew = 1000;             // added to a spool's: its fibers lie otherwise
inline constexpr std::uint64_t kFirstSeedOfCloth = 500;        // of a spool's; those before are its own threads'

}  // namespace station

// The unevenness of yarns: seeded deviations of the yarns of a patch from each other and along themselves; the patch
// still repeats without a seam.
#pragma once

#include <random>
#include <vector>

#include "renderer/weave/patch.h"

namespace renderer {

// A random wave at `count` even places of a closed line of `length_mm`: mean 0, variance 1 over seeds, correlation
// exp(-(d / correlation_mm)^2) at the distance d. Cycles that the line or its places cannot hold are left out, so that
// the correlation is as asked where correlation_mm is more than two steps and less than a fifth of the line; a longer
// one gives one slow wave.
std::vector<double> closed_noise(int count, double length_mm, double correlation_mm, std::mt19937_64& random);

// Makes the yarns of an initial_patch() of this draft as uneven as the draft says, in radius, place and shade, and
// along each yarn in thickness (whose mean stays 1), twist (where it has plies) and shades. Nothing changes where all
// scales are 0.
void make_uneven(YarnPatch& patch, const Draft& draft);

// Deviations along a yarn are cut at this many times their scale.
inline constexpr double kMostDeviation = 3;

}  // namespace renderer

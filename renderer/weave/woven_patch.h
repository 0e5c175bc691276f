// From a draft to the patch that is rendered: yarns at rest, and what makes them less ideal than round, equal ones; each an
// option.
#pragma once

#include <cstdint>

#include "renderer/weave/relaxation.h"

namespace renderer {

// Yarns that differ from each other; along the cloth the patch still repeats without a seam. Normal deviations cut at
// twice their scale.
struct Unevenness {
  double radius = 0;  // scale of the deviation of a yarn's radius, of the radius
  double pitch = 0;   // of its place from the even sett, of the room between its neighbours and it
  int shades = 1;     // thread t becomes one of the threads t shades .. t shades + shades - 1
  std::uint64_t seed = 1;
};

// Yarns of plies twisted round their centre line.
struct Plies {
  int count = 1;
  double turns_per_mm = 0.5;  // rounded to whole turns in a period, so that the patch repeats
  double radius_mm = 0;       // of a ply; 0: as large as lets the plies touch each other inside the yarn
};

struct WovenOptions {
  RelaxationOptions relaxation{};
  // N / mm^2. A yarn under a load of q per length is lower than round by 1 + q / (modulus x diameter), and so much wider: an
  // ellipse of the same area, as wide as the sett lets it be at most. 0: sections keep the draft's flatness.
  double transverse_modulus_n_mm2 = 0;
  Unevenness unevenness{};
  Plies plies{};
};
inline constexpr double kMostUnevenness = 0.2;
inline constexpr int kMostShades = 64, kMostPlies = 12;
inline constexpr double kMostTurnsPerMm = 20;

// Errors: std::runtime_error, one line: those of check_draft() and check_at_rest(); options out of range.
RelaxedPatch woven_patch(const Draft& draft, const WovenOptions& options = {});

// Each yarn of the patch as its plies; what was measured stays that of the yarns.
YarnPatch with_plies(const YarnPatch& patch, const Plies& plies);
double ply_radius_mm(const Plies& plies, double yarn_radius_mm);

}  // namespace renderer

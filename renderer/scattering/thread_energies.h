// The lobes' energies lambda_p of the thread model in coordinates in which simple bounds are exactly what eq. 5 needs
// [Xia 2025]: every lambda_p >= 0 for all c in 0..1, lambda_0 concave, lambda_2 falling.
//
//   lambda_0 = L0 (1-c) + L1 c + k c(1-c)                      L0, L1, k >= 0
//   lambda_1 = r1a c                                           r1a >= 0
//   lambda_2 = 1/(r2a c + r2b) - 1/(r2a + r2b) + n2            r2a, r2b > 0 (logarithms), n2 >= 0
//
// The paper instead clamps r0c and penalises r0a + r0b > 0, which fixes a trend but does not make the energies
// positive.
#pragma once

#include <cmath>

#include "renderer/scattering/thread.h"

namespace renderer {

// The order of the unknowns.
enum EnergyUnknown { kEnergyL0, kEnergyL1, kEnergyConcavity, kEnergyR1a, kEnergyLogR2a, kEnergyLogR2b, kEnergyN2 };
inline constexpr int kEnergyUnknownCount = 7;

// Bounds of r2a and r2b. No view sees lambda_2 near grazing angles, and without the bound 1 / r2b would grow without
// end.
inline constexpr double kLeastR2b = 1e-2, kLeastR2a = 1e-4, kMostR2 = 1e4;
inline constexpr double kMostEnergyTerm = 4;  // upper bound of L0, L1, k, r1a and n2; sums of energies are near 1

// Sets the paper's r0a ... r2c of `p` from the seven unknowns `u`.
template <class S>
void set_energies(const S* u, BasicThreadParameters<S>& p) {
  using std::exp;
  p.r0a = -u[kEnergyConcavity];
  p.r0b = u[kEnergyL1] - u[kEnergyL0] + u[kEnergyConcavity];
  p.r0c = u[kEnergyL0];
  p.r1a = u[kEnergyR1a];
  p.r2a = exp(u[kEnergyLogR2a]);
  p.r2b = exp(u[kEnergyLogR2b]);
  p.r2c = u[kEnergyN2] - S(1.0) / (p.r2a + p.r2b);
}

}  // namespace renderer

// The lobes' energies lambda_p of the thread model in coordinates in which simple bounds are exactly what eq. 5 needs
// [Xia 2025]: every lambda_p >= 0 for all c in 0..1, lambda_0 concave, lambda_2 falling.
//
//   lambda_0 = L0 (1-c) + L1 c + k c(1-c)                      L0, L1, k >= 0
//   lambda_1 = r1a c                                           r1a >= 0
//   lambda_2 = n2 + d2 (1-c) / (1 - w2 (1-c))                  d2, n2 >= 0, 0 < w2 < 1
//
// d2 is how fast lambda_2 falls at c = 1, w2 how much faster it does at grazing angles: 0 is a straight line, 1 a pole.
// That is eq. 5 with r2a = w2^2 / d2, r2b = w2 (1-w2) / d2, r2c = n2 - d2 / w2. Views tell n2 and d2 apart, while r2a
// and r2b vary together over orders of magnitude where lambda_2 at the angles that are seen stays as it is.
//
// The paper instead clamps r0c and penalises r0a + r0b > 0, which fixes a trend but does not make the energies
// positive.
#pragma once

#include <cmath>

#include "renderer/scattering/thread.h"

namespace renderer {

// The order of the unknowns.
enum EnergyUnknown { kEnergyL0, kEnergyL1, kEnergyConcavity, kEnergyR1a, kEnergyD2, kEnergyW2, kEnergyN2 };
inline constexpr int kEnergyUnknownCount = 7;

// No view sees lambda_2 near grazing angles, and without the bound it would grow without end there. The least d2 and w2
// keep the terms of eq. 5 finite.
inline constexpr double kLeastD2 = 1e-3, kLeastW2 = 0.05, kMostW2 = 0.999;
inline constexpr double kMostEnergyTerm = 4;  // upper bound of L0, L1, k, r1a, d2 and n2; sums of energies are near 1

// Sets the paper's r0a ... r2c of `p` from the seven unknowns `u`.
template <class S>
void set_energies(const S* u, BasicThreadParameters<S>& p) {
  const S d2 = u[kEnergyD2], w2 = u[kEnergyW2];
  p.r0a = -u[kEnergyConcavity];
  p.r0b = u[kEnergyL1] - u[kEnergyL0] + u[kEnergyConcavity];
  p.r0c = u[kEnergyL0];
  p.r1a = u[kEnergyR1a];
  p.r2a = w2 * w2 / d2;
  p.r2b = w2 * (S(1.0) - w2) / d2;
  p.r2c = u[kEnergyN2] - d2 / w2;
}

}  // namespace renderer

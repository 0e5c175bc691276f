// Energies of a fitted thread's lobes over the angle, with their standard deviations: what views determine well even where
// single parameters trade off against each other.
#pragma once

#include <array>
#include <vector>

#include "inversion/fit_views.h"

namespace inversion {

struct EnergyBand {
  double cosine = 0;                               // c = |cos theta| of the viewing direction
  std::array<double, 3> lambda{}, sigma{};         // R, TT, TRT
  double sum = 0, sum_sigma = 0;                   // of the three: the albedo without absorption
  std::array<double, 3> albedo{}, albedo_sigma{};  // with it, RGB, mean over the thread's width
};

// At c = 0.1, 0.2 ... 1, from the total covariance, linearised.
std::vector<EnergyBand> energy_bands(const ViewFit& fit);
// From another covariance of the fit's unknowns.
std::vector<EnergyBand> energy_bands(const ViewFit& fit, const Eigen::MatrixXd& covariance);
// Of a thread that was fitted earlier, at these c (0 to 1); `covariance` of its unknowns, all zero when not known.
std::vector<EnergyBand> energy_bands(const ThreadUnknowns& at, const Eigen::MatrixXd& covariance,
                                     const std::vector<double>& cosines);

}  // namespace inversion

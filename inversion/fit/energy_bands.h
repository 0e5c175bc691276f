// Energies of a fitted thread's lobes over the angle, with their standard deviations: what views determine well even
// where single parameters trade off against each other.
#pragma once

#include <array>
#include <vector>

#include "inversion/fit/view_fit.h"

namespace inversion {

struct EnergyBand {
  double cosine = 0;                               // c = |cos theta| of the viewing direction
  std::array<double, 3> lambda{}, sigma{};         // R, TT, TRT
  double sum = 0, sum_sigma = 0;                   // of the three: the albedo without absorption
  std::array<double, 3> albedo{}, albedo_sigma{};  // with absorption, RGB, mean over the thread's width
};

// The bands at c = 0.1, 0.2 ... 1, with deviations from the fit's total covariance, linearised.
std::vector<EnergyBand> energy_bands(const ViewFit& fit);
// The same from another covariance of the fit's unknowns.
std::vector<EnergyBand> energy_bands(const ViewFit& fit, const Eigen::MatrixXd& covariance);
// The bands of a thread that was fitted earlier, at these c (0 to 1), from its unknowns, with the tint or without;
// `covariance` is theirs, all zero when not known.
std::vector<EnergyBand> energy_bands(const Eigen::VectorXd& at, const Eigen::MatrixXd& covariance,
                                     const std::vector<double>& cosines);

}  // namespace inversion

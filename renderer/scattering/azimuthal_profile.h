// A lobe of the thread model as a distribution over azimuth alone: averaged over the thread's width, as seen from far
// away, and over bins of azimuth, as simulations and gonioreflectometers deliver it (Xia et al. 2025, section 3.3).
#pragma once

#include <Eigen/Core>

namespace renderer {

// Per bin: the mean over offsets h in [-1, 1] of T(h) N_p(phi; s), T to the power 0 for p = 0 and 1 otherwise, and its
// derivatives. Bin i of n covers -pi + [i, i+1] 2 pi / n; phi = 0 is back. Per radian; integrates to the mean T.
struct AzimuthalProfile {
  Eigen::ArrayXd density, by_scale, by_absorption;
};

// Lobe p in 0..2 at inclination theta; `scale` is the logistic's s, `sigma_a` per thread radius (0: the
// derivative by it is left out). Bins are integrated in closed form, offsets by as many steps as the lobe's width needs.
AzimuthalProfile azimuthal_profile(int p, double theta_rad, double eta, double scale, double sigma_a, int bins);

// The same logistic around one azimuth: no offsets, no absorption.
AzimuthalProfile logistic_profile(double center, double scale, int bins);

// Lobe p = 0, 1, 2, ... of one smooth fiber: where Fresnel and Snell send the light of its whole width, with what is left
// of it; the mean over each bin. `sigma_a` per fiber radius.
Eigen::ArrayXd smooth_fiber_lobe(int p, double theta_rad, double eta, double sigma_a, int bins);

}  // namespace renderer

// A lobe of the thread model as a distribution over azimuth alone: its mean over the thread's width, as seen from far
// away, in bins of azimuth, as simulations and gonioreflectometers deliver it (Xia et al. 2025, section 3.3).
#pragma once

#include <Eigen/Core>

namespace renderer {

// A lobe's density in each bin, per radian, and its derivatives by the logistic's scale s and by sigma_a. The density
// is the mean over offsets h in [-1, 1] of T(h)^k N_p(phi; s), with k = 0 for p = 0 and k = 1 otherwise, and integrates
// to the mean T^k. Bin i of n covers -pi + [i, i+1] 2 pi / n; phi = 0 is back.
struct AzimuthalProfile {
  Eigen::ArrayXd density, by_scale, by_absorption;
};

// The profile of lobe p in 0..2 at inclination theta; `scale` is the logistic's s, `sigma_a` is per thread radius (at 0
// the derivative by it is left out). Bins are integrated in closed form, offsets in as many steps as the lobe's width
// needs.
AzimuthalProfile azimuthal_profile(int p, double theta_rad, double eta, double scale, double sigma_a, int bins);

// The profile of the same logistic around one azimuth, without offsets and without absorption.
AzimuthalProfile logistic_profile(double center, double scale, int bins);

// The density of lobe p = 0, 1, 2, ... of one smooth fiber, per radian, mean over each bin: the light that falls on the
// fiber's whole width goes where Fresnel and Snell send it, and is weakened as they and `sigma_a` (per fiber radius)
// say.
Eigen::ArrayXd smooth_fiber_lobe(int p, double theta_rad, double eta, double sigma_a, int bins);

}  // namespace renderer

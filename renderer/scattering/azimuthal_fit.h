// Fits of azimuthal distributions of scattered light, simulated or measured, by the thread model and by the yarn
// baseline (Xia et al. 2025, section 3.3): each inclination by itself, or inclinations and absorptions jointly.
//
// All fits minimise the sum of squared differences of densities, which is to minimise the relative L2 error |fit -
// data| / |data| over all bins of all distributions of the fit.
#pragma once

#include <Eigen/Core>
#include <array>
#include <functional>
#include <string>
#include <vector>

#include "renderer/scattering/density_fit.h"
#include "renderer/scattering/thread.h"
#include "renderer/scattering/thread_energies.h"
#include "renderer/scattering/yarn.h"

namespace renderer {

// The thread model fitted to one inclination. Unknowns: beta (3), lambda (3) and, where the fibers absorb, sigma_a.
struct SeparateThreadFit : AzimuthalFit {
  std::array<double, 3> beta{}, lambda{};
  double sigma_a = 0;  // per thread radius
};
SeparateThreadFit fit_thread_separately(const AzimuthalData& data);

// The thread model fitted to several inclinations and absorptions together: the energies follow eq. 5, and each
// absorption of the data has a sigma_a of its own.
struct JointThreadFit : AzimuthalFit {
  ThreadParameters parameters;      // sigma_a and alpha keep their defaults: the data do not tell them
  std::vector<double> absorptions;  // the distinct absorptions of the data, rising
  std::vector<double> sigma_a;      // found for each, per thread radius; 0 for no absorption
};
JointThreadFit fit_thread_jointly(const std::vector<AzimuthalData>& data);

// The yarn baseline fitted to several inclinations and absorptions together. Unknowns: eta (which gives C_R), gamma_tt
// and, for each absorption of the data, a sigma_a per yarn radius. Every fiber count of kSweptFiberCounts is tried and
// the best kept.
struct YarnFit : AzimuthalFit {
  YarnParameters parameters;
  std::vector<double> absorptions, sigma_a;
};
inline constexpr std::array<int, 8> kSweptFiberCounts{1, 2, 5, 10, 20, 40, 80, 160};
YarnFit fit_yarn(const std::vector<AzimuthalData>& data, double radius_ratio);

// The fit of a forward lobe and an azimuthally uniform rest with free energies and width: the best that any model with
// uniform back lobes can do at one inclination.
AzimuthalFit fit_forward_and_uniform(const AzimuthalData& data);

}  // namespace renderer

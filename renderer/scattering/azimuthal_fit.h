// Fits of azimuthal distributions of scattered light, simulated or measured, by the thread model and by the yarn
// baseline (Xia et al. 2025, section 3.3): each inclination by itself, or inclinations and absorptions jointly.
//
// All fits minimise the sum of squared differences of densities, so that the relative L2 error
// |fit - data| / |data| (over all bins of all distributions of the fit) is what is smallest.
#pragma once

#include <Eigen/Core>
#include <array>
#include <functional>
#include <string>
#include <vector>

#include "renderer/scattering/thread.h"
#include "renderer/scattering/thread_energies.h"
#include "renderer/scattering/yarn.h"

namespace renderer {

struct AzimuthalData {
  double theta_rad = 0;
  double eta = 1.5;        // index of refraction for the lobes' centres
  double absorption = 0;   // of the fibers, in any unit: distributions of equal absorption share one sigma_a
  Eigen::ArrayXd density;  // per radian, bin i of n covers -pi + [i, i+1] 2 pi / n, phi = 0 is back
};

// |fit - data| / |data| in L2 over all bins.
double relative_error(const std::vector<AzimuthalData>& data, const std::vector<Eigen::ArrayXd>& fit);

// One unknown of a fit as found: `deviation` is its standard deviation from the Jacobian and the residuals' variance;
// infinite when the data do not determine it.
struct FittedValue {
  std::string name;
  double value = 0, deviation = 0;
  bool at_bound = false;
};

// A combination of unknowns that the data hardly determine: the weakest directions of the Jacobian, in units of the
// unknowns' natural scales (1 for roughnesses and energies; logarithms for r2a and r2b).
struct WeakDirection {
  double deviation = 0;                               // standard deviation along the direction
  std::vector<std::pair<std::string, double>> parts;  // the largest components
};

struct AzimuthalFit {
  double error = 0;                       // relative L2
  std::vector<double> errors;             // of each distribution by itself
  std::vector<Eigen::ArrayXd> densities;  // fitted, as the data
  std::vector<FittedValue> values;
  std::vector<WeakDirection> weak;
  bool converged = false;
};

// The thread model at one inclination: beta (3), lambda (3) and, where the fibers absorb, sigma_a.
struct SeparateThreadFit : AzimuthalFit {
  std::array<double, 3> beta{}, lambda{};
  double sigma_a = 0;  // per thread radius
};
SeparateThreadFit fit_thread_separately(const AzimuthalData& data);

// Jointly over inclinations with eq. 5, and over absorptions with one sigma_a each.
struct JointThreadFit : AzimuthalFit {
  ThreadParameters parameters;      // sigma_a and alpha as they are by default: the data do not say
  std::vector<double> absorptions;  // distinct ones of the data, rising
  std::vector<double> sigma_a;      // found for each, per thread radius; 0 for no absorption
};
JointThreadFit fit_thread_jointly(const std::vector<AzimuthalData>& data);

// The yarn baseline: eta (of C_R), gamma_tt and one absorption per yarn radius for each of the data's; the fiber count
// is swept and the best kept.
struct YarnFit : AzimuthalFit {
  YarnParameters parameters;
  std::vector<double> absorptions, sigma_a;
};
inline constexpr std::array<int, 8> kSweptFiberCounts{1, 2, 5, 10, 20, 40, 80, 160};
YarnFit fit_yarn(const std::vector<AzimuthalData>& data, double radius_ratio);

// A forward lobe and an azimuthally uniform rest with free energies and width: the best that any model with uniform back
// lobes can do at one inclination.
AzimuthalFit fit_forward_and_uniform(const AzimuthalData& data);

}  // namespace renderer

// Least-squares fits of densities over azimuth with bounded unknowns: the machinery below azimuthal_fit.h.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <string>
#include <vector>

namespace renderer {

// One distribution of scattered light over azimuth, at one inclination and absorption.
struct AzimuthalData {
  double theta_rad = 0;
  double eta = 1.5;        // index of refraction for the lobes' centres
  double absorption = 0;   // of the fibers, in any unit; distributions with the same absorption share one sigma_a
  Eigen::ArrayXd density;  // per radian, bin i of n covers -pi + [i, i+1] 2 pi / n, phi = 0 is back
};

// The relative error |fit - data| / |data| in L2 over all bins of all distributions.
double relative_error(const std::vector<AzimuthalData>& data, const std::vector<Eigen::ArrayXd>& fit);

// One unknown of a fit as found. `deviation` is its standard deviation from the Jacobian and the residuals' variance,
// infinite when the data do not determine the unknown.
struct FittedValue {
  std::string name;
  double value = 0, deviation = 0;
  bool at_bound = false;
};

// A combination of unknowns that the data hardly determine: one of the weakest directions of the Jacobian, in units of
// the unknowns' natural scales (1 for roughnesses and energies; logarithms for r2a and r2b).
struct WeakDirection {
  double deviation = 0;                               // standard deviation along the direction
  std::vector<std::pair<std::string, double>> parts;  // the direction's largest components, by name
};

struct AzimuthalFit {
  double error = 0;                       // relative L2
  std::vector<double> errors;             // relative L2 of each distribution by itself
  std::vector<Eigen::ArrayXd> densities;  // the fitted distributions, in the bins of the data
  std::vector<FittedValue> values;
  // Of the values, in their order, by how they move when one distribution after the other is left out (a jackknife
  // [Efron 1982], by one Gauss-Newton step each): residuals are mostly the model's own error, alike in neighbouring
  // bins, so that only distributions count as independent. 0 for values at a bound, and for a single distribution.
  Eigen::MatrixXd covariance;
  std::vector<WeakDirection> weak;
  bool converged = false;
};

struct FitUnknown {
  std::string name;
  double low = 0, high = 1;
};

// A model to be fitted: its unknowns, and a function that computes its density for distribution k of the data and, when
// asked for (`by_unknown` not null), the derivatives as a matrix of bins x unknowns, which is zero on entry.
struct DensityModel {
  std::vector<FitUnknown> unknowns;
  std::function<void(std::size_t k, const Eigen::VectorXd& u, Eigen::ArrayXd& density, Eigen::MatrixXd* by_unknown)>
      evaluate;
};

// Fits the model by Levenberg-Marquardt from each of the starts, fills all of `fit` from the best result and returns
// its unknowns.
Eigen::VectorXd fit_densities(const std::vector<AzimuthalData>& data, const DensityModel& model,
                              const std::vector<Eigen::VectorXd>& starts, AzimuthalFit& fit);

}  // namespace renderer

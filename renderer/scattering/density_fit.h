// Least squares of densities over azimuth with bounded unknowns, the machinery below azimuthal_fit.h.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <string>
#include <vector>

#include "renderer/scattering/azimuthal_fit.h"

namespace renderer {

struct FitUnknown {
  std::string name;
  double low = 0, high = 1;
};

// What is fitted: unknowns and, for distribution k of the data, the model's density and (when asked for) its
// derivatives, bins x unknowns, zero on entry.
struct DensityModel {
  std::vector<FitUnknown> unknowns;
  std::function<void(std::size_t k, const Eigen::VectorXd& u, Eigen::ArrayXd& density, Eigen::MatrixXd* by_unknown)>
      evaluate;
};

// Fills all of `fit` from the best of several starts (Levenberg-Marquardt from each); returns the unknowns.
Eigen::VectorXd fit_densities(const std::vector<AzimuthalData>& data, const DensityModel& model,
                              const std::vector<Eigen::VectorXd>& starts, AzimuthalFit& fit);

}  // namespace renderer

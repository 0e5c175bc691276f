#include "inversion/fit/energy_bands.h"

#include <cmath>

namespace inversion {
namespace {

constexpr int kValues = 7;  // three energies, their sum, three albedos
using Values = Eigen::Matrix<double, kValues, 1>;

Values values_at(const Eigen::VectorXd& unknowns, double cosine) {
  constexpr int kOffsets = 16;
  renderer::ThreadParameters p =
      unknowns.size() == kTintedCount ? tinted_parameters_of(unknowns) : parameters_of(unknowns);
  p.limit_energy = false;
  const auto lambda = renderer::thread_lobe_energies<double>(p, cosine);
  Values values;
  values << lambda[0], lambda[1], lambda[2], lambda[0] + lambda[1] + lambda[2], 0, 0, 0;
  const double sine = std::sqrt(std::max(0.0, 1 - cosine * cosine));
  for (int i = 0; i < kOffsets; ++i) {
    const double h = (i + 0.5) / kOffsets;
    const renderer::InnerChord<double> chord(h, sine, cosine, renderer::kThreadEta);
    const auto through = renderer::thread_transmittance(p, chord.length);
    for (int c = 0; c < 3; ++c)
      values[4 + c] +=
          (lambda[0] * p.lambda0_rgb[c] + lambda[1] * through.tt[c] + lambda[2] * through.trt[c]) / kOffsets;
  }
  return values;
}

}  // namespace

std::vector<EnergyBand> energy_bands(const ViewFit& fit) {
  return energy_bands(fit, fit.certainty.covariance);
}

std::vector<EnergyBand> energy_bands(const ViewFit& fit, const Eigen::MatrixXd& covariance) {
  std::vector<double> tenths;
  for (int tenth = 1; tenth <= 10; ++tenth) tenths.push_back(tenth / 10.0);
  return energy_bands(fit.unknowns, covariance, tenths);
}

std::vector<EnergyBand> energy_bands(const Eigen::VectorXd& at, const Eigen::MatrixXd& covariance,
                                     const std::vector<double>& cosines) {
  constexpr double kStep = 1e-5;
  std::vector<EnergyBand> bands;
  for (const double cosine : cosines) {
    const Values values = values_at(at, cosine);
    Eigen::Matrix<double, kValues, Eigen::Dynamic> slopes(kValues, at.size());
    for (Eigen::Index k = 0; k < at.size(); ++k) {
      Eigen::VectorXd beside = at;
      beside[k] += kStep;
      slopes.col(k) = (values_at(beside, cosine) - values) / kStep;
    }
    const Values sigma = (slopes * covariance * slopes.transpose()).diagonal().cwiseMax(0.0).cwiseSqrt();
    bands.push_back({.cosine = cosine,
                     .lambda = {values[0], values[1], values[2]},
                     .sigma = {sigma[0], sigma[1], sigma[2]},
                     .sum = values[3],
                     .sum_sigma = sigma[3],
                     .albedo = {values[4], values[5], values[6]},
                     .albedo_sigma = {sigma[4], sigma[5], sigma[6]}});
  }
  return bands;
}

}  // namespace inversion

#include "renderer/scattering/azimuthal_fit.h"

#include <ceres/jet.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "renderer/scattering/azimuthal_profile.h"
#include "renderer/scattering/density_fit.h"

namespace renderer {
namespace {

using Eigen::ArrayXd;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kLeastRoughness = 0.02, kMostAbsorption = 50;

struct WithSlope {
  double value, slope;
};
WithSlope scale_of(double beta) {
  const ceres::Jet<double, 1> s = azimuthal_scale(ceres::Jet<double, 1>(beta, 0));
  return {s.a, s.v[0]};
}

const std::array<FitUnknown, 3> kBetas{FitUnknown{"beta_R", kLeastRoughness, 1},
                                       FitUnknown{"beta_TT", kLeastRoughness, 1},
                                       FitUnknown{"beta_TRT", kLeastRoughness, 1}};

std::vector<double> distinct_absorptions(const std::vector<AzimuthalData>& data) {
  std::vector<double> all;
  for (const AzimuthalData& d : data) all.push_back(d.absorption);
  std::sort(all.begin(), all.end());
  all.erase(std::unique(all.begin(), all.end()), all.end());
  return all;
}

// One sigma_a for each absorption of the data; white fibers make a thread without absorption.
std::vector<FitUnknown> sigma_unknowns(const std::vector<double>& absorptions) {
  std::vector<FitUnknown> unknowns;
  for (double absorption : absorptions)
    if (absorption > 0) unknowns.push_back({"sigma_a[" + std::to_string(unknowns.size()) + "]", 0, kMostAbsorption});
  return unknowns;
}

// Index of the unknown for this absorption, counted from `first`; -1 without absorption.
Eigen::Index sigma_index(const std::vector<double>& absorptions, double absorption, Eigen::Index first) {
  if (!(absorption > 0)) return -1;
  const auto at = std::lower_bound(absorptions.begin(), absorptions.end(), absorption) - absorptions.begin();
  return first + at - (absorptions.front() > 0 ? 0 : 1);
}

std::vector<double> found_sigmas(const std::vector<double>& absorptions, const VectorXd& u, Eigen::Index first) {
  std::vector<double> sigma;
  for (double absorption : absorptions) {
    const Eigen::Index at = sigma_index(absorptions, absorption, first);
    sigma.push_back(at < 0 ? 0 : u[at]);
  }
  return sigma;
}

// The three lobes of one distribution with energies lambda; unknowns 0..2 are the betas, `sigma` the absorption's
// (-1: none). Returns each lobe's profile, for the derivatives by whatever makes the energies.
std::array<ArrayXd, 3> add_lobes(const AzimuthalData& data, const VectorXd& u, const std::array<double, 3>& lambda,
                                 Eigen::Index sigma, ArrayXd& density, MatrixXd* by_unknown) {
  std::array<ArrayXd, 3> profiles;
  for (int p = 0; p < 3; ++p) {
    const auto i = static_cast<std::size_t>(p);
    const WithSlope scale = scale_of(u[p]);
    const AzimuthalProfile profile = azimuthal_profile(p, data.theta_rad, data.eta, scale.value,
                                                       sigma < 0 ? 0 : u[sigma], static_cast<int>(data.density.size()));
    density += lambda[i] * profile.density;
    if (by_unknown) {
      by_unknown->col(p) += (lambda[i] * scale.slope * profile.by_scale).matrix();
      if (sigma >= 0) by_unknown->col(sigma) += (lambda[i] * profile.by_absorption).matrix();
    }
    profiles[i] = profile.density;
  }
  return profiles;
}

// Where fits start: the solutions for white and for dyed bundles, of coarse and fine fibers, lie near one of them.
constexpr std::array<std::array<double, 3>, 4> kStartBetas{
    {{0.6, 0.6, 0.1}, {0.5, 0.85, 0.2}, {0.5, 0.8, 0.3}, {0.8, 0.4, 0.05}}};
const std::array<std::vector<double>, 2> kStartEnergies{std::vector<double>{0.6, 0.3, 0.4, 0.6, 0.08, 0.97, 0.03},
                                                        std::vector<double>{0.4, 0.02, 0.05, 0.9, 0.09, 0.985, 0.1}};

VectorXd start_of(const std::array<double, 3>& beta, const std::vector<double>& energies, std::size_t sigmas) {
  VectorXd start(3 + static_cast<Eigen::Index>(energies.size() + sigmas));
  start.setConstant(0.3);  // sigma_a
  std::copy(beta.begin(), beta.end(), start.data());
  std::copy(energies.begin(), energies.end(), start.data() + 3);
  return start;
}

using YarnJet = ceres::Jet<double, 3>;  // eta, gamma_tt, the distribution's sigma_a

// The yarn's density and its derivatives; unknowns 0 and 1 are eta and gamma_tt, `sigma` the absorption's (-1: none).
void add_yarn(const AzimuthalData& data, const BasicYarnParameters<YarnJet>& parameters, Eigen::Index sigma,
              ArrayXd& density, MatrixXd* by_unknown) {
  const YarnModel<YarnJet> yarn(parameters);
  const auto bins = static_cast<int>(data.density.size());
  const Vec3<double> wo(std::sin(data.theta_rad), std::cos(data.theta_rad), 0);
  const auto add = [&](const YarnJet& energy, const ArrayXd& shape, const ArrayXd& by_scale, const YarnJet& scale) {
    density += energy.a * shape;
    if (!by_unknown) return;
    const std::array<Eigen::Index, 3> columns{0, 1, sigma};
    for (int i = 0; i < 3; ++i)
      if (columns[static_cast<std::size_t>(i)] >= 0)
        by_unknown->col(columns[static_cast<std::size_t>(i)]) +=
            (energy.v[i] * shape + energy.a * scale.v[i] * by_scale).matrix();
  };
  // The lobes change with h only through the number of fibers on the chord: one profile for each number.
  constexpr int kOffsets = 1000;
  const ArrayXd uniform = ArrayXd::Constant(bins, 1 / (2 * std::numbers::pi)), none = ArrayXd::Zero(bins);
  const auto offset = [](int index) { return (index + 0.5) / kOffsets; };
  const auto on_chord = [&](int index) {
    return fibers_on_chord(parameters.fiber_count, parameters.radius_ratio, offset(index));
  };
  for (int i = 0; i < kOffsets;) {
    const int from = i, n = on_chord(from);
    while (i < kOffsets && on_chord(i) == n) ++i;
    const CurveLobes<YarnJet> lobes = yarn.lobes_at(offset(from), wo);
    const YarnJet share(static_cast<double>(i - from) / kOffsets), scale = lobes.widths->s[1];
    const AzimuthalProfile forward = logistic_profile(std::numbers::pi, scale.a, bins);
    add(share * (lobes.attenuation(0, 0) + lobes.attenuation(2, 0)), uniform, none, YarnJet(0.0));
    add(share * lobes.attenuation(1, 0), forward.density, forward.by_scale, scale);
  }
}

}  // namespace

SeparateThreadFit fit_thread_separately(const AzimuthalData& data) {
  constexpr Eigen::Index kLambda = 3, kSigma = 6;
  const std::size_t sigmas = data.absorption > 0 ? 1 : 0;
  DensityModel model;
  model.unknowns.assign(kBetas.begin(), kBetas.end());
  for (const char* name : {"lambda_0", "lambda_1", "lambda_2"}) model.unknowns.push_back({name, 0, kMostEnergyTerm});
  for (const FitUnknown& sigma : sigma_unknowns({data.absorption})) model.unknowns.push_back(sigma);
  model.evaluate = [&](std::size_t, const VectorXd& u, ArrayXd& density, MatrixXd* by_unknown) {
    const std::array<ArrayXd, 3> profiles =
        add_lobes(data, u, {u[kLambda], u[kLambda + 1], u[kLambda + 2]}, sigmas ? kSigma : -1, density, by_unknown);
    for (int p = 0; by_unknown && p < 3; ++p)
      by_unknown->col(kLambda + p) = profiles[static_cast<std::size_t>(p)].matrix();
  };
  std::vector<VectorXd> starts;
  for (const auto& beta : kStartBetas) starts.push_back(start_of(beta, {0.4, 0.5, 0.1}, sigmas));
  SeparateThreadFit fit;
  const VectorXd u = fit_densities({data}, model, starts, fit);
  for (std::size_t p = 0; p < 3; ++p) {
    fit.beta[p] = u[static_cast<Eigen::Index>(p)];
    fit.lambda[p] = u[kLambda + static_cast<Eigen::Index>(p)];
  }
  fit.sigma_a = sigmas ? u[kSigma] : 0;
  return fit;
}

JointThreadFit fit_thread_jointly(const std::vector<AzimuthalData>& data) {
  using Jet = ceres::Jet<double, kEnergyUnknownCount>;
  constexpr Eigen::Index kEnergies = 3, kSigma = kEnergies + kEnergyUnknownCount;
  JointThreadFit fit;
  fit.absorptions = distinct_absorptions(data);
  DensityModel model;
  model.unknowns.assign(kBetas.begin(), kBetas.end());
  for (const char* name : {"L0", "L1", "concavity", "r1a"}) model.unknowns.push_back({name, 0, kMostEnergyTerm});
  model.unknowns.push_back({"d2", kLeastD2, kMostEnergyTerm});
  model.unknowns.push_back({"w2", kLeastW2, kMostW2});
  model.unknowns.push_back({"n2", 0, kMostEnergyTerm});
  const std::vector<FitUnknown> sigmas = sigma_unknowns(fit.absorptions);
  model.unknowns.insert(model.unknowns.end(), sigmas.begin(), sigmas.end());
  model.evaluate = [&](std::size_t k, const VectorXd& u, ArrayXd& density, MatrixXd* by_unknown) {
    std::array<Jet, kEnergyUnknownCount> energy;
    for (int i = 0; i < kEnergyUnknownCount; ++i) energy[static_cast<std::size_t>(i)] = Jet(u[kEnergies + i], i);
    BasicThreadParameters<Jet> parameters;
    parameters.limit_energy = false;
    set_energies(energy.data(), parameters);
    const std::array<Jet, 3> lambda = thread_lobe_energies<Jet>(parameters, std::cos(data[k].theta_rad));
    const std::array<ArrayXd, 3> profiles =
        add_lobes(data[k], u, {lambda[0].a, lambda[1].a, lambda[2].a},
                  sigma_index(fit.absorptions, data[k].absorption, kSigma), density, by_unknown);
    for (std::size_t p = 0; by_unknown && p < 3; ++p)
      for (int i = 0; i < kEnergyUnknownCount; ++i)
        by_unknown->col(kEnergies + i) += (lambda[p].v[i] * profiles[p]).matrix();
  };
  std::vector<VectorXd> starts;
  for (const auto& beta : kStartBetas)
    for (const auto& energies : kStartEnergies) starts.push_back(start_of(beta, energies, sigmas.size()));
  const VectorXd u = fit_densities(data, model, starts, fit);
  for (std::size_t p = 0; p < 3; ++p) fit.parameters.beta[p] = u[static_cast<Eigen::Index>(p)];
  set_energies(u.data() + kEnergies, fit.parameters);
  fit.sigma_a = found_sigmas(fit.absorptions, u, kSigma);
  return fit;
}

YarnFit fit_yarn(const std::vector<AzimuthalData>& data, double radius_ratio) {
  constexpr Eigen::Index kSigma = 2;
  const std::vector<double> absorptions = distinct_absorptions(data);
  DensityModel model;
  model.unknowns = {{"eta", 1.01, 3}, {"gamma_TT", kLeastRoughness, 1}};
  for (const FitUnknown& sigma : sigma_unknowns(absorptions)) model.unknowns.push_back(sigma);
  std::vector<VectorXd> starts;
  for (double gamma : {0.3, 0.7}) {
    VectorXd start = VectorXd::Constant(static_cast<Eigen::Index>(model.unknowns.size()), 0.5);
    start[0] = 1.5, start[1] = gamma;
    starts.push_back(start);
  }
  YarnFit best;
  best.error = std::numeric_limits<double>::infinity();
  for (int fibers : kSweptFiberCounts) {
    model.evaluate = [&](std::size_t k, const VectorXd& u, ArrayXd& density, MatrixXd* by_unknown) {
      const Eigen::Index sigma = sigma_index(absorptions, data[k].absorption, kSigma);
      BasicYarnParameters<YarnJet> parameters{.fiber_count = fibers, .radius_ratio = radius_ratio};
      parameters.eta = YarnJet(u[0], 0), parameters.gamma_tt = YarnJet(u[1], 1);
      parameters.sigma_a.setConstant(sigma < 0 ? YarnJet(0.0) : YarnJet(u[sigma], 2));
      add_yarn(data[k], parameters, sigma, density, by_unknown);
    };
    YarnFit fit;
    const VectorXd u = fit_densities(data, model, starts, fit);
    if (fit.error >= best.error) continue;
    fit.parameters = {.fiber_count = fibers, .radius_ratio = radius_ratio};
    fit.parameters.eta = u[0], fit.parameters.gamma_tt = u[1];
    fit.absorptions = absorptions;
    fit.sigma_a = found_sigmas(absorptions, u, kSigma);
    best = fit;
  }
  return best;
}

AzimuthalFit fit_forward_and_uniform(const AzimuthalData& data) {
  const auto bins = static_cast<int>(data.density.size());
  DensityModel model;
  model.unknowns = {
      {"beta_TT", kLeastRoughness, 1}, {"forward energy", 0, kMostEnergyTerm}, {"uniform energy", 0, kMostEnergyTerm}};
  model.evaluate = [&](std::size_t, const VectorXd& u, ArrayXd& density, MatrixXd* by_unknown) {
    const WithSlope scale = scale_of(u[0]);
    const AzimuthalProfile forward = azimuthal_profile(1, data.theta_rad, data.eta, scale.value, 0, bins);
    density = u[1] * forward.density + u[2] / (2 * std::numbers::pi);
    if (!by_unknown) return;
    by_unknown->col(0) = (u[1] * scale.slope * forward.by_scale).matrix();
    by_unknown->col(1) = forward.density.matrix();
    by_unknown->col(2).setConstant(1 / (2 * std::numbers::pi));
  };
  AzimuthalFit fit;
  fit_densities({data}, model, {VectorXd{{0.3, 0.5, 0.3}}, VectorXd{{0.8, 0.5, 0.3}}}, fit);
  return fit;
}

}  // namespace renderer

#include "inversion/fit/scattering_family.h"

#include <ceres/ceres.h>

#include <cmath>
#include <utility>

namespace inversion {
namespace {

using Eigen::VectorXd;
using RgbByUnknowns = Eigen::Matrix<double, 3, Eigen::Dynamic>;
using renderer::kThreadParameterCount;

constexpr double kGamma = 1e-4;          // of eq. 6's hinges
constexpr double kHingeRounding = 1e-3;  // below this a hinge is rounded, so that it has a derivative
constexpr int kEnergyAngles = 33;        // c = 0, where no view sees how high lambda_2 rises, to c = 1
// Weight of the mean squared excess: 1 % of it costs as much as a tenth of the data term.
constexpr double kEnergyPenalty = 30;
constexpr double kMostFiberAbsorption = 50;  // per radius: black
constexpr double kLeastRoughness = 0.02;

// Energy beyond 1, below 0 where there is less, in the channel that R sends most of, at evenly spaced c, both ends
// included: it is there that fits exceed it first. Of a thread with `count` unknowns.
template <int count>
struct EnergyExcess {
  template <class S>
  bool operator()(const S* u, S* residuals) const {
    renderer::BasicThreadParameters<S> p;
    renderer::set_energies(u + kL0, p);
    p.limit_energy = false;
    S tint(1.0);
    if constexpr (count == kTintedCount)
      for (const int k : {kTintRed, kTintBlue})
        if (exp(u[k]) > tint) tint = exp(u[k]);
    const double weight = std::sqrt(2 * kEnergyPenalty / kEnergyAngles);
    for (int i = 0; i < kEnergyAngles; ++i) {
      const double c = i / (kEnergyAngles - 1.0);
      const auto lambda = renderer::thread_lobe_energies<S>(p, c);
      residuals[i] = S(weight) * (tint * lambda[0] + lambda[1] + lambda[2] - S(1.0));
    }
    return true;
  }
};

template <int count>
struct EnergyTerm {
  template <class S>
  bool operator()(const S* u, S* residuals) const {
    EnergyExcess<count>()(u, residuals);
    for (int i = 0; i < kEnergyAngles; ++i)
      if (!(residuals[i] > S(0.0))) residuals[i] = S(0.0);
    return true;
  }
};

template <int count>
EnergyLimits limits_at(const VectorXd& unknowns) {
  EnergyLimits limits{.excess = VectorXd(kEnergyAngles), .rows = Eigen::MatrixXd(kEnergyAngles, count)};
  Eigen::Matrix<double, kEnergyAngles, count, Eigen::RowMajor> rows;
  const double* parameters = unknowns.data();
  double* jacobian = rows.data();
  ceres::AutoDiffCostFunction<EnergyExcess<count>, kEnergyAngles, count>(new EnergyExcess<count>)
      .Evaluate(&parameters, limits.excess.data(), &jacobian);
  limits.rows = rows;
  return limits;
}

// The weighted sum of unknowns where positive, as in eq. 6.
struct Hinge {
  std::vector<std::pair<int, double>> summed;  // unknown and weight

  template <class S>
  bool operator()(const S* u, S* residual) const {
    S sum(0.0);
    for (const auto& [unknown, weight] : summed) sum += S(weight) * u[unknown];
    residual[0] = sum > S(0.0) ? sum : S(0.0);
    return true;
  }
};

// Huber's loss is linear beyond the rounding: half of it times the scale is gamma |x|.
template <int count>
void add_hinge(ceres::Problem& problem, double* unknowns, Hinge hinge) {
  problem.AddResidualBlock(
      new ceres::AutoDiffCostFunction<Hinge, 1, count>(new Hinge(std::move(hinge))),
      new ceres::ScaledLoss(new ceres::HuberLoss(kHingeRounding), kGamma / kHingeRounding, ceres::TAKE_OWNERSHIP),
      unknowns);
}

template <int count>
void add_thread_penalties(ceres::Problem& problem, double* unknowns, bool with_energies) {
  if (with_energies)
    problem.AddResidualBlock(
        new ceres::AutoDiffCostFunction<EnergyTerm<count>, kEnergyAngles, count>(new EnergyTerm<count>), nullptr,
        unknowns);
  add_hinge<count>(problem, unknowns, {{{kL1, 1}, {kL0, -1}}});  // lambda_0(1) - lambda_0(0)
}

VectorXd vector_of(std::initializer_list<double> numbers) {
  VectorXd vector(static_cast<Eigen::Index>(numbers.size()));
  std::copy(numbers.begin(), numbers.end(), vector.data());
  return vector;
}

FamilyUnknowns with_tint(FamilyUnknowns of) {
  constexpr double kMostTint = 5;  // in the logarithm: one colour alone
  const auto longer = [](const VectorXd& numbers, double two) {
    VectorXd all(kTintedCount);
    all << numbers, two, two;
    return all;
  };
  of.names.insert(of.names.end(), {"tint_r", "tint_b"});
  of.lower = longer(of.lower, -kMostTint);
  of.upper = longer(of.upper, kMostTint);
  for (VectorXd& start : of.starts) start = longer(start, 0);
  return of;
}

FamilyUnknowns thread_unknowns() {
  std::vector<VectorXd> starts{unknowns_of(starting_thread())};
  for (const renderer::ThreadParameters& start : other_starting_threads()) starts.emplace_back(unknowns_of(start));
  return {.names = {"sigma_a_r", "sigma_a_g", "sigma_a_b", "alpha_r", "alpha_tt", "alpha_trt", "beta_r", "beta_tt",
                    "beta_trt", "l0", "l1", "kappa", "r1a", "d2", "w2", "n2"},
          .lower = lower_bounds(),
          .upper = upper_bounds(),
          .starts = std::move(starts),
          .azimuthal_roughnesses = {kBeta, kBeta + 1, kBeta + 2}};
}

FamilyUnknowns unknowns(const ThreadFamily& family) {
  return family.tinted ? with_tint(thread_unknowns()) : thread_unknowns();
}

FamilyUnknowns unknowns(const FiberFamily&) {
  return {.names = {"sigma_a_r", "sigma_a_g", "sigma_a_b", "beta_m", "beta_n"},
          .lower = vector_of({0, 0, 0, kLeastRoughness, kLeastRoughness}),
          .upper = vector_of({kMostFiberAbsorption, kMostFiberAbsorption, kMostFiberAbsorption, 1, 1}),
          .starts = {vector_of({0.3, 0.3, 0.3, 0.3, 0.3}), vector_of({0.1, 0.1, 0.1, 0.6, 0.6}),
                     vector_of({1, 1, 1, 0.4, 0.9})},
          .azimuthal_roughnesses = {4}};
}

FamilyUnknowns unknowns(const YarnFamily&) {
  return {.names = {"sigma_a_r", "sigma_a_g", "sigma_a_b", "beta_r", "beta_tt", "gamma_tt"},
          .lower = vector_of({0, 0, 0, kLeastRoughness, kLeastRoughness, kLeastRoughness}),
          .upper = vector_of({kMostFiberAbsorption, kMostFiberAbsorption, kMostFiberAbsorption, 1, 1, 1}),
          .starts = {vector_of({0.3, 0.3, 0.3, 0.3, 0.3, 0.3}), vector_of({1, 1, 1, 0.5, 0.2, 0.6})}};
}

FamilyUnknowns unknowns(const BundleFamily&) {
  FamilyUnknowns of = unknowns(FiberFamily{});
  of.starts = {vector_of({0.1, 0.1, 0.1, 0.5, 0.5})};
  return of;
}

// The unknowns are the thread's parameters. The paper clamps r0c and r1a to be non-negative and roughnesses and
// absorption have a range of their own; the other energies are free.
FamilyUnknowns unknowns(const PaperFamily&) {
  constexpr double kMostPrinted = 1e4;  // energy, which the paper leaves free
  const renderer::ThreadParameters p = starting_thread();
  VectorXd lower = lower_bounds(), upper = upper_bounds(), start(kThreadParameterCount);
  start << p.sigma_a, p.alpha[0], p.alpha[1], p.alpha[2], p.beta[0], p.beta[1], p.beta[2], p.r0a, p.r0b, p.r0c, p.r1a,
      p.r2a, p.r2b, p.r2c;
  lower.tail(kThreadParameterCount - kR0a).setConstant(-kMostPrinted);
  upper.tail(kThreadParameterCount - kR0a).setConstant(kMostPrinted);
  lower[kR0c] = lower[kR1] = 0;
  return {.names = {"sigma_a_r", "sigma_a_g", "sigma_a_b", "alpha_r", "alpha_tt", "alpha_trt", "beta_r", "beta_tt",
                    "beta_trt", "r0a", "r0b", "r0c", "r1a", "r2a", "r2b", "r2c"},
          .lower = lower,
          .upper = upper,
          .starts = {start}};
}

renderer::ThreadParameters parameters(const PaperFamily&, const VectorXd& u) {
  std::array<double, kThreadParameterCount> parameters{};
  std::copy(u.begin(), u.end(), parameters.begin());
  renderer::ThreadParameters p = renderer::thread_parameters(parameters, false);
  p.exit = renderer::ThreadExit::entry_point;
  return p;
}

renderer::ThreadParameters parameters(const ThreadFamily& family, const VectorXd& u) {
  renderer::ThreadParameters p = family.tinted ? tinted_parameters_of(u) : parameters_of(u);
  p.exit = family.exit;
  p.transmittance_powers = family.transmittance_powers;
  return p;
}

renderer::FiberParameters parameters(const FiberFamily&, const VectorXd& u) {
  return {.sigma_a = u.head<3>(), .beta_m = u[3], .beta_n = u[4]};
}

renderer::BundleParameters parameters(const BundleFamily& family, const VectorXd& u) {
  return {.fiber_count = family.fiber_count,
          .radius_ratio = std::sqrt(family.packing / family.fiber_count),
          .fiber = parameters(FiberFamily{}, u)};
}

renderer::YarnParameters parameters(const YarnFamily& family, const VectorXd& u) {
  return {.fiber_count = family.fiber_count,
          .radius_ratio = std::sqrt(kYarnPacking / family.fiber_count),
          .sigma_a = u.head<3>(),
          .beta_r = u[3],
          .beta_tt = u[4],
          .gamma_tt = u[5]};
}

// The tint is that over green, because the largest of the three has a corner where another becomes it.
BlockShader shader(const ThreadFamily& family, const VectorXd& u) {
  renderer::ThreadParameters p = parameters_of(u.head<kThreadParameterCount>());
  p.transmittance_powers = family.transmittance_powers;
  ThreadShader shader{.model = block_model(p), .parameters_by_unknowns = {kThreadParameterCount + 3, u.size()}};
  shader.parameters_by_unknowns.setZero();
  shader.parameters_by_unknowns.topLeftCorner<kThreadParameterCount, kThreadParameterCount>() =
      parameters_by_unknowns(u.head<kThreadParameterCount>());
  if (family.tinted) {
    p.lambda0_rgb = tint_of(u);
    shader.model = block_model(p);
    shader.parameters_by_unknowns(kThreadParameterCount, kTintRed) = p.lambda0_rgb[0];
    shader.parameters_by_unknowns(kThreadParameterCount + 2, kTintBlue) = p.lambda0_rgb[2];
  }
  return shader;
}

BlockShader shader(const PaperFamily& family, const VectorXd& u) {
  ThreadShader shader{.model = block_model(parameters(family, u)),
                      .parameters_by_unknowns = {kThreadParameterCount + 3, u.size()}};
  shader.parameters_by_unknowns.setIdentity();
  return shader;
}

// Bundles are shaded fiber by fiber.
BlockShader shader(const BundleFamily& family, const VectorXd& u) {
  return block_model(parameters(family, u).fiber);
}

template <class Family>
BlockShader shader(const Family& family, const VectorXd& u) {
  return block_model(parameters(family, u));
}

const BlockModel& model_of(const ThreadShader& shader) {
  return shader.model;
}

template <class Model>
const Model& model_of(const Model& model) {
  return model;
}

// RGB x parameters: sigma_a of the three channels, then the parameters of the next rows of slopes.
template <int kSlopeCount>
Eigen::Matrix<double, 3, kSlopeCount + 2> by_parameters(const renderer::ThreadSlopes<double>& slopes) {
  Eigen::Matrix<double, 3, kSlopeCount + 2> rows;
  rows.setZero();
  for (int c = 0; c < 3; ++c) {
    rows(c, c) = slopes(0, c);
    for (int k = 1; k < kSlopeCount; ++k) rows(c, k + 2) = slopes(k, c);
  }
  return rows;
}

RgbByUnknowns by_unknowns_of(const ThreadShader& shader, const renderer::ThreadSlopes<double>& slopes) {
  Eigen::Matrix<double, 3, kThreadParameterCount + 3> rows;
  rows.setZero();
  rows.leftCols<kThreadParameterCount>() = by_parameters<renderer::kSlopeTint>(slopes);
  for (int c = 0; c < 3; ++c) rows(c, kThreadParameterCount + c) = slopes(renderer::kSlopeTint, c);
  return rows * shader.parameters_by_unknowns;
}

// The unknowns are the parameters.
template <class Model>
RgbByUnknowns by_unknowns_of(const Model&, const renderer::ThreadSlopes<double>& slopes) {
  return by_parameters<Model::kSlopeCount>(slopes);
}

}  // namespace

FamilyUnknowns unknowns_of(const ScatteringFamily& family) {
  return std::visit([](const auto& of) { return unknowns(of); }, family);
}

renderer::ScatteringModel model_at(const ScatteringFamily& family, const VectorXd& u) {
  return std::visit([&](const auto& of) { return renderer::ScatteringModel(parameters(of, u)); }, family);
}

void add_penalties(const ScatteringFamily& family, ceres::Problem& problem, double* unknowns, bool with_energies) {
  if (std::holds_alternative<PaperFamily>(family)) {
    add_hinge<kThreadParameterCount>(problem, unknowns, {{{kR0a, 1}, {kR0b, 1}}});
    add_hinge<kThreadParameterCount>(problem, unknowns, {{{kR2b, -1}}});
    add_hinge<kThreadParameterCount>(problem, unknowns, {{{kR0a, 1}}});
    return;
  }
  if (const auto* thread = std::get_if<ThreadFamily>(&family))
    thread->tinted ? add_thread_penalties<kTintedCount>(problem, unknowns, with_energies)
                   : add_thread_penalties<kThreadParameterCount>(problem, unknowns, with_energies);
}

EnergyLimits energy_limits(const ScatteringFamily& family, const VectorXd& u) {
  const auto* thread = std::get_if<ThreadFamily>(&family);
  if (!thread) return {.excess = VectorXd(0), .rows = Eigen::MatrixXd(0, u.size())};
  return thread->tinted ? limits_at<kTintedCount>(u) : limits_at<kThreadParameterCount>(u);
}

BlockShader shader_at(const ScatteringFamily& family, const VectorXd& u) {
  return std::visit([&](const auto& of) { return shader(of, u); }, family);
}

BlockEstimate shade(const BlockShader& shader, const LightPaths& paths, std::size_t block, bool with_slopes) {
  return std::visit([&](const auto& of) { return shade_block(paths, block, model_of(of), with_slopes); }, shader);
}

RgbByUnknowns by_unknowns(const BlockShader& shader, const renderer::ThreadSlopes<double>& slopes) {
  return std::visit([&](const auto& of) { return by_unknowns_of(of, slopes); }, shader);
}

renderer::ThreadParameters starting_thread() {
  renderer::ThreadParameters p;
  p.sigma_a.setConstant(0.3);
  return p;
}

std::vector<renderer::ThreadParameters> other_starting_threads() {
  renderer::ThreadParameters clear = starting_thread(), dark = starting_thread();
  clear.sigma_a.setConstant(0.1);
  clear.alpha = {0.4, 0.3, 0.3};
  clear.beta = {0.9, 0.6, 0.6};
  dark.sigma_a.setConstant(0.6);
  dark.alpha = {0.15, 0.3, 0.8};
  dark.beta = {0.9, 0.6, 0.3};
  return {clear, dark};
}

renderer::ThreadParameters metallic_starting_thread() {
  renderer::ThreadParameters metal = starting_thread();
  metal.sigma_a.setConstant(0.6);
  metal.alpha = {0.15, 0.3, 0.3};
  metal.beta = {0.5, 0.6, 0.3};
  ThreadUnknowns unknowns = unknowns_of(metal);
  unknowns[kL0] = unknowns[kL1] = 0.6, unknowns[kConcavity] = 0, unknowns[kR1a] = 0.2, unknowns[kN2] = 0.1;
  return parameters_of(unknowns);
}

}  // namespace inversion

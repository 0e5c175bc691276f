// The unknowns that the fit varies: the 16 thread parameters, with the energies in the positive form of
// thread_energies.h. Of a thread whose highlight has a colour of its own two more come behind them: the logarithms of
// how much red and blue lobe R sends back over green. That is lambda0_rgb but for its scale, which lambda_0 has.
#pragma once

#include <Eigen/Core>
#include <array>
#include <string>

#include "renderer/scattering/thread_energies.h"

namespace inversion {

// The order of the unknowns; sigma_a is R G B, alpha and beta are three each.
enum Unknown {
  kSigma = 0,
  kAlpha = 3,
  kBeta = 6,
  kL0 = 9,
  kL1,
  kConcavity,
  kR1a,
  kD2,
  kW2,
  kN2
};  // from kL0 on: EnergyUnknown
// The energies among a thread's parameters as printed (renderer::thread_parameters).
enum PrintedEnergy { kR0a = kL0, kR0b, kR0c, kR1, kR2a, kR2b, kR2c };
using ThreadUnknowns = Eigen::Matrix<double, renderer::kThreadParameterCount, 1>;
inline constexpr int kTintRed = renderer::kThreadParameterCount, kTintBlue = kTintRed + 1, kTintedCount = kTintRed + 2;
using ThreadJacobian = Eigen::Matrix<double, renderer::kThreadParameterCount, renderer::kThreadParameterCount>;

// The unknowns of these parameters, or the nearest ones within the bounds; and the parameters of unknowns.
ThreadUnknowns unknowns_of(const renderer::ThreadParameters& parameters);
renderer::ThreadParameters parameters_of(const ThreadUnknowns& unknowns);
// The same with the tint: kTintedCount numbers.
Eigen::VectorXd tinted_unknowns_of(const renderer::ThreadParameters& parameters);
renderer::ThreadParameters tinted_parameters_of(const Eigen::VectorXd& unknowns);
// What R sends back over green, RGB; lambda_0 is then that of green.
Eigen::Vector3d tint_of(const Eigen::VectorXd& unknowns);
// The derivatives d parameter (order of renderer::thread_parameters) / d unknown.
ThreadJacobian parameters_by_unknowns(const ThreadUnknowns& unknowns);

ThreadUnknowns lower_bounds();
ThreadUnknowns upper_bounds();

// The groups that a fit may hold at their start, to see what each is good for.
enum class ParameterGroup { sigma_a, alpha, beta, r };
inline constexpr std::array<ParameterGroup, 4> kParameterGroups{ParameterGroup::sigma_a, ParameterGroup::alpha,
                                                                ParameterGroup::beta, ParameterGroup::r};
std::string name_of(ParameterGroup group);
ParameterGroup group_of(int unknown);

}  // namespace inversion

// What the fit varies: the 16 thread parameters in coordinates whose simple bounds are exactly the constraints of
// eqs. 4-5 [Xia 2025] (every lambda_p >= 0 for all c in 0..1, lambda_0 concave, lambda_2 falling).
//
//   lambda_0 = L0 (1-c) + L1 c + k c(1-c)                      L0, L1, k >= 0
//   lambda_1 = r1a c                                           r1a >= 0
//   lambda_2 = 1/(r2a c + r2b) - 1/(r2a + r2b) + n2            r2a, r2b > 0 (logarithms), n2 >= 0
//
// The paper clamps r0c and penalises r0a + r0b > 0 instead; that is a trend, not positivity (models.md 1.7).
#pragma once

#include <Eigen/Core>
#include <array>
#include <cmath>
#include <string>

#include "renderer/scattering/thread.h"

namespace inversion {

// Their order; sigma_a is R G B, alpha and beta are three each.
enum Unknown { kSigma = 0, kAlpha = 3, kBeta = 6, kL0 = 9, kL1, kConcavity, kR1a, kLogR2a, kLogR2b, kN2 };
using ThreadUnknowns = Eigen::Matrix<double, renderer::kThreadParameterCount, 1>;
using ThreadJacobian = Eigen::Matrix<double, renderer::kThreadParameterCount, renderer::kThreadParameterCount>;

// The nearest unknowns within the bounds.
ThreadUnknowns unknowns_of(const renderer::ThreadParameters& parameters);
renderer::ThreadParameters parameters_of(const ThreadUnknowns& unknowns);
// d parameter (order of renderer::thread_parameters) / d unknown.
ThreadJacobian parameters_by_unknowns(const ThreadUnknowns& unknowns);

// The part of parameters_of that sets the lobes' energies r, for dual numbers too.
template <class S>
void set_energies(const S* u, renderer::BasicThreadParameters<S>& p) {
  using std::exp;
  p.r0a = -u[kConcavity];
  p.r0b = u[kL1] - u[kL0] + u[kConcavity];
  p.r0c = u[kL0];
  p.r1a = u[kR1a];
  p.r2a = exp(u[kLogR2a]);
  p.r2b = exp(u[kLogR2b]);
  p.r2c = u[kN2] - S(1.0) / (p.r2a + p.r2b);
}

ThreadUnknowns lower_bounds();
ThreadUnknowns upper_bounds();

// The groups that a fit may hold at their start, to see what each is good for.
enum class ParameterGroup { sigma_a, alpha, beta, r };
inline constexpr std::array<ParameterGroup, 4> kParameterGroups{ParameterGroup::sigma_a, ParameterGroup::alpha,
                                                                ParameterGroup::beta, ParameterGroup::r};
std::string name_of(ParameterGroup group);
ParameterGroup group_of(int unknown);

}  // namespace inversion

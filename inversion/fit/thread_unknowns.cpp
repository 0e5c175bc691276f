#include "inversion/fit/thread_unknowns.h"

#include <cmath>

namespace inversion {
namespace {

constexpr double kMostAbsorption = 50;  // per thread radius: black
constexpr double kLeastRoughness = 0.02, kLeastTint = 1e-3;
using renderer::kLeastD2, renderer::kLeastW2, renderer::kMostW2, renderer::kMostEnergyTerm;

}  // namespace

using Eigen::VectorXd;

ThreadUnknowns unknowns_of(const renderer::ThreadParameters& p) {
  ThreadUnknowns u;
  const double l1 = p.r0a + p.r0b + p.r0c, sum2 = p.r2a + p.r2b;
  u << p.sigma_a, p.alpha[0], p.alpha[1], p.alpha[2], p.beta[0], p.beta[1], p.beta[2], p.r0c, l1, -p.r0a, p.r1a,
      p.r2a / (sum2 * sum2), p.r2a / sum2, p.r2c + 1 / sum2;
  return u.cwiseMax(lower_bounds()).cwiseMin(upper_bounds());
}

renderer::ThreadParameters parameters_of(const ThreadUnknowns& u) {
  renderer::ThreadParameters p;
  p.sigma_a = u.head<3>();
  for (int i = 0; i < 3; ++i) {
    p.alpha[static_cast<std::size_t>(i)] = u[kAlpha + i];
    p.beta[static_cast<std::size_t>(i)] = u[kBeta + i];
  }
  renderer::set_energies(u.data() + kL0, p);
  return p;
}

VectorXd tinted_unknowns_of(const renderer::ThreadParameters& p) {
  const Eigen::Array3d tint = p.lambda0_rgb.array().max(kLeastTint);
  renderer::ThreadParameters green = p;
  green.r0a *= tint[1], green.r0b *= tint[1], green.r0c *= tint[1];
  VectorXd u(kTintedCount);
  u << unknowns_of(green), std::log(tint[0] / tint[1]), std::log(tint[2] / tint[1]);
  return u;
}

Eigen::Vector3d tint_of(const VectorXd& u) {
  return {std::exp(u[kTintRed]), 1, std::exp(u[kTintBlue])};
}

renderer::ThreadParameters tinted_parameters_of(const VectorXd& u) {
  renderer::ThreadParameters p = parameters_of(u.head<renderer::kThreadParameterCount>());
  const Eigen::Vector3d tint = tint_of(u);
  const double most = tint.maxCoeff();
  p.lambda0_rgb = tint / most;
  p.r0a *= most, p.r0b *= most, p.r0c *= most;
  return p;
}

ThreadJacobian parameters_by_unknowns(const ThreadUnknowns& u) {
  ThreadJacobian j = ThreadJacobian::Zero();
  for (int i = 0; i < kL0; ++i) j(i, i) = 1;
  j(kR0a, kConcavity) = -1;
  j(kR0b, kL0) = -1, j(kR0b, kL1) = 1, j(kR0b, kConcavity) = 1;
  j(kR0c, kL0) = 1;
  j(kR1, kR1a) = 1;
  const double d = u[kD2], w = u[kW2];
  j(kR2a, kD2) = -w * w / (d * d), j(kR2a, kW2) = 2 * w / d;
  j(kR2b, kD2) = -w * (1 - w) / (d * d), j(kR2b, kW2) = (1 - 2 * w) / d;
  j(kR2c, kD2) = -1 / w, j(kR2c, kW2) = d / (w * w), j(kR2c, kN2) = 1;
  return j;
}

ThreadUnknowns lower_bounds() {
  ThreadUnknowns low = ThreadUnknowns::Zero();
  low.segment<6>(kAlpha).setConstant(kLeastRoughness);
  low[kD2] = kLeastD2;
  low[kW2] = kLeastW2;
  return low;
}

ThreadUnknowns upper_bounds() {
  ThreadUnknowns high = ThreadUnknowns::Constant(kMostEnergyTerm);
  high.head<3>().setConstant(kMostAbsorption);
  high.segment<6>(kAlpha).setOnes();
  high[kW2] = kMostW2;
  return high;
}

std::string name_of(ParameterGroup group) {
  switch (group) {
    case ParameterGroup::sigma_a:
      return "sigma_a";
    case ParameterGroup::alpha:
      return "alpha";
    case ParameterGroup::beta:
      return "beta";
    case ParameterGroup::r:
      break;
  }
  return "r";
}

ParameterGroup group_of(int unknown) {
  if (unknown < kAlpha) return ParameterGroup::sigma_a;
  if (unknown < kBeta) return ParameterGroup::alpha;
  return unknown < kL0 ? ParameterGroup::beta : ParameterGroup::r;
}

}  // namespace inversion

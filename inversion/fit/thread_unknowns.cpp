#include "inversion/fit/thread_unknowns.h"

#include <cmath>

namespace inversion {
namespace {

constexpr double kMostAbsorption = 50;  // per thread radius: black
constexpr double kLeastRoughness = 0.02, kLeastTint = 1e-3;
using renderer::kLeastR2a, renderer::kLeastR2b, renderer::kMostR2, renderer::kMostEnergyTerm;

}  // namespace

using Eigen::VectorXd;

ThreadUnknowns unknowns_of(const renderer::ThreadParameters& p) {
  ThreadUnknowns u;
  const double l1 = p.r0a + p.r0b + p.r0c;
  u << p.sigma_a, p.alpha[0], p.alpha[1], p.alpha[2], p.beta[0], p.beta[1], p.beta[2], p.r0c, l1, -p.r0a, p.r1a,
      std::log(std::max(p.r2a, kLeastR2a)), std::log(std::max(p.r2b, kLeastR2b)), p.r2c + 1 / (p.r2a + p.r2b);
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
  const double a = std::exp(u[kLogR2a]), b = std::exp(u[kLogR2b]), sum2 = (a + b) * (a + b);
  j(kR2a, kLogR2a) = a;
  j(kR2b, kLogR2b) = b;
  j(kR2c, kLogR2a) = a / sum2, j(kR2c, kLogR2b) = b / sum2, j(kR2c, kN2) = 1;
  return j;
}

ThreadUnknowns lower_bounds() {
  ThreadUnknowns low = ThreadUnknowns::Zero();
  low.segment<6>(kAlpha).setConstant(kLeastRoughness);
  low[kLogR2a] = std::log(kLeastR2a);
  low[kLogR2b] = std::log(kLeastR2b);
  return low;
}

ThreadUnknowns upper_bounds() {
  ThreadUnknowns high = ThreadUnknowns::Constant(kMostEnergyTerm);
  high.head<3>().setConstant(kMostAbsorption);
  high.segment<6>(kAlpha).setOnes();
  high[kLogR2a] = high[kLogR2b] = std::log(kMostR2);
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

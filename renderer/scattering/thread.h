// Scattering of a whole thread seen as one cylinder (Xia et al. 2025, equations 4 and 5): three lobes whose widths and
// energies are free parameters, because they stand for everything that happens between the thread's many fibers.
//
//   f_cos = sum over p = R, TT, TRT of  M(theta_o, theta_i; v(alpha_p)) N(phi; s(beta_p), Phi_p) A_p        (RGB)
//   A_R = lambda_0(c),  A_TT = lambda_1(c) T,  A_TRT = lambda_2(c) T,  T = exp(-sigma_a 2 cos gamma_t / cos theta_t)
//   lambda_0 = r0a c^2 + r0b c + r0c,   lambda_1 = r1a c,   lambda_2 = 1 / (r2a c + r2b) + r2c,   c = |cos theta_o|
//
//   parameter  | unit              | count | differentiable
//   sigma_a    | 1 / thread radius | 3     | yes   absorption, RGB
//   alpha      | 0.02 .. 1         | 3     | yes   longitudinal roughness of each lobe (perceptual, mapped as fibers')
//   beta       | 0.02 .. 1         | 3     | yes   azimuthal roughness of each lobe (perceptual, mapped as fibers')
//   r          | -                 | 7     | yes   energies of the lobes, all colours alike; each lambda must stay >= 0
//
// Three options that fits leave alone; the defaults of the first two are the printed model:
//
//   lambda0_rgb          | 0 .. 1 | 1 1 1    | dual numbers only tint of A_R: metallic threads have coloured highlights
//   transmittance_powers | >= 0   | 1 1      | no                A_TT = lambda_1 T^first, A_TRT = lambda_2 T^second
//   exit                 | -      | far_side |                   where scattered light leaves (ThreadExit)
//
// f_cos includes the cosine (lobes.h). theta_o, h and the attenuations belong to the known direction o, as for fibers.
// Lobe centres Phi_p are a fiber's, with the refractive index fixed at kThreadEta. Nothing in the paper bounds lambda_0
// + lambda_1 + lambda_2, the albedo without absorption, and fits exceed 1 near grazing angles; `limit_energy` scales
// the three down to kMostEnergy where their sum exceeds it. Fits of parameters leave `limit_energy` off and penalise
// the excess instead.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cmath>

#include "renderer/scattering/lobes.h"

namespace renderer {

inline constexpr double kThreadEta = 1.55;
inline constexpr double kMostEnergy = 0.999;
// The least probability with which each lobe is sampled, so that derivatives by a lobe without energy can be estimated.
inline constexpr double kLobeFloor = 0.05;

// Where scattered light leaves a thread (renderer/trace/light_exit.h).
//   entry_point | where it came in, as with curves that scatter like a single fiber
//   far_side    | where it came in if it leaves on that side, otherwise anywhere across the far side, as light that
//               | has wandered among many fibers does
//   wandering   | where it leaves simulated bundles of fibers, given where it came in and how far it turned
enum class ThreadExit { entry_point, far_side, wandering };

template <class S>
struct BasicThreadParameters {
  Eigen::Matrix<S, 3, 1> sigma_a{S(0.0), S(0.0), S(0.0)};  // absorption per thread radius, RGB
  std::array<S, 3> alpha{S(0.3), S(0.3), S(0.3)};          // longitudinal roughness of R, TT, TRT
  std::array<S, 3> beta{S(0.55), S(0.6), S(0.15)};         // azimuthal roughness of R, TT, TRT
  S r0a = S(-0.4), r0b = S(0.15), r0c = S(0.55);           // lambda_0
  S r1a = S(0.6);                                          // lambda_1
  S r2a = S(10.0), r2b = S(2.5), r2c = S(0.0);             // lambda_2
  bool limit_energy = true;
  Eigen::Matrix<S, 3, 1> lambda0_rgb{S(1.0), S(1.0), S(1.0)};  // tint of R, at most 1
  std::array<double, 2> transmittance_powers{1, 1};            // of TT and TRT
  ThreadExit exit = ThreadExit::far_side;
};
using ThreadParameters = BasicThreadParameters<double>;

// The 16 parameters in the order sigma_a, alpha, beta, r0a r0b r0c, r1a, r2a r2b r2c.
inline constexpr int kThreadParameterCount = 16;
template <class S>
BasicThreadParameters<S> thread_parameters(const std::array<S, kThreadParameterCount>& p, bool limit_energy) {
  return {{p[0], p[1], p[2]}, {p[3], p[4], p[5]}, {p[6], p[7], p[8]}, p[9], p[10], p[11], p[12], p[13], p[14], p[15],
          limit_energy};
}

// The same parameters in another scalar.
template <class T, class S>
BasicThreadParameters<T> in_scalar(const BasicThreadParameters<S>& p) {
  const auto three = [](const std::array<S, 3>& v) {
    return std::array<T, 3>{static_cast<T>(v[0]), static_cast<T>(v[1]), static_cast<T>(v[2])};
  };
  return {p.sigma_a.template cast<T>(),
          three(p.alpha),
          three(p.beta),
          static_cast<T>(p.r0a),
          static_cast<T>(p.r0b),
          static_cast<T>(p.r0c),
          static_cast<T>(p.r1a),
          static_cast<T>(p.r2a),
          static_cast<T>(p.r2b),
          static_cast<T>(p.r2c),
          p.limit_energy,
          p.lambda0_rgb.template cast<T>(),
          p.transmittance_powers,
          p.exit};
}

// The transmittances T^first of TT and T^second of TRT along one chord, RGB.
template <class S>
struct ThreadTransmittance {
  Rgb<S> tt, trt;
};
template <class S>
ThreadTransmittance<S> thread_transmittance(const BasicThreadParameters<S>& p, const Vec3<S>& sigma_a,
                                            const S& chord_length) {
  const auto [first, second] = p.transmittance_powers;
  const Rgb<S> tt = (sigma_a.array() * (-chord_length * S(first))).exp();
  if (first == second) return {tt, tt};
  return {tt, (sigma_a.array() * (-chord_length * S(second))).exp()};
}
template <class S>
ThreadTransmittance<S> thread_transmittance(const BasicThreadParameters<S>& p, const S& chord_length) {
  return thread_transmittance(p, p.sigma_a, chord_length);
}

// The energies lambda_0, lambda_1, lambda_2 at c = |cos theta_o|, limited when `limit_energy` is set.
template <class S>
std::array<S, 3> thread_lobe_energies(const BasicThreadParameters<S>& p, const Geometry<S>& c) {
  const S cosine(c);
  std::array<S, 3> lambda{(p.r0a * cosine + p.r0b) * cosine + p.r0c, p.r1a * cosine,
                          S(1.0) / (p.r2a * cosine + p.r2b) + p.r2c};
  if (p.limit_energy) {
    const S sum = lambda[0] + lambda[1] + lambda[2];
    const S scale = select(sum > S(kMostEnergy), S(S(kMostEnergy) / sum), S(1.0));
    for (S& energy : lambda) energy *= scale;
  }
  return lambda;
}

// The model with everything computed that depends on the parameters but not on directions.
template <class S>
class ThreadModel {
 public:
  explicit ThreadModel(const BasicThreadParameters<S>& parameters) : parameters_(parameters) {
    for (int p = 0; p < 3; ++p) {
      const auto i = static_cast<std::size_t>(p);
      widths_.set(p, longitudinal_variance(parameters.alpha[i]), azimuthal_scale(parameters.beta[i]));
    }
    widths_.set(3, S(1.0), S(1.0));  // has no energy and is never sampled
  }
  // The same model in another scalar.
  template <class T>
  explicit ThreadModel(const ThreadModel<T>& other)
      : parameters_(in_scalar<S>(other.parameters_)), widths_(other.widths_.template cast<S>()) {}

  // The lobes seen from unit direction wo (local frame) at offset h = sin(gamma_o) in [-1, 1].
  CurveLobes<S> lobes_at(const Geometry<S>& h, const Vec3<Geometry<S>>& wo) const {
    return lobes_at(h, wo, parameters_.sigma_a);
  }
  // The lobes of the same thread with another absorption.
  CurveLobes<S> lobes_at(const Geometry<S>& h, const Vec3<Geometry<S>>& wo, const Vec3<S>& sigma_a) const {
    using std::asin, std::sqrt;
    const Geometry<S> sin_o = wo.x(), cos_o = sqrt(wo.y() * wo.y() + wo.z() * wo.z());
    CurveLobes<S> lobes;
    lobes.widths = &widths_;
    lobes.set_azimuth(wo);
    lobes.sin_theta_o = Lanes<S>::Constant(S(sin_o));
    lobes.cos_theta_o = Lanes<S>::Constant(S(cos_o));
    const InnerChord<S> chord(h, sin_o, cos_o, S(kThreadEta));
    for (int p = 0; p < 3; ++p) lobes.center[p] = lobe_center<S>(p, S(asin(h)), chord.gamma_t);

    const std::array<S, 3> lambda = thread_lobe_energies<S>(parameters_, cos_o);
    const ThreadTransmittance<S> transmittance = thread_transmittance<S>(parameters_, sigma_a, chord.length);
    lobes.attenuation.row(0) = (parameters_.lambda0_rgb.array() * lambda[0]).transpose();
    lobes.attenuation.row(1) = (transmittance.tt * lambda[1]).transpose();
    lobes.attenuation.row(2) = (transmittance.trt * lambda[2]).transpose();
    lobes.empty_lanes_from(3);
    set_probabilities(lobes);
    return lobes;
  }

  ThreadExit exit() const { return parameters_.exit; }
  const Vec3<S>& absorption() const { return parameters_.sigma_a; }

 private:
  template <class>
  friend class ThreadModel;

  // Sets the probabilities in proportion to the lobes' mean energies, mixed with kLobeFloor.
  static void set_probabilities(CurveLobes<S>& lobes) {
    const Lanes<S> energy = lobes.attenuation.rowwise().sum().max(S(0.0));
    const S total = energy.sum();
    const S share = S(1.0 - 3 * kLobeFloor);
    const auto bright = total > S(0.0);
    for (int p = 0; p < 3; ++p)
      lobes.probability[p] = S(kLobeFloor) + share * select(bright, S(energy[p] / total), S(1.0 / 3));
  }

  BasicThreadParameters<S> parameters_;
  LobeWidths<S> widths_;
};

}  // namespace renderer

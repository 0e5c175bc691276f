// The yarn model, a baseline: a yarn as one cylinder whose scattering is aggregated analytically from that of its
// fibers, in the manner of Zhu et al. 2023 ("A practical and hierarchical yarn-based shading model for cloth").
//
// This is a reconstruction and not their model, whose formulas were not at hand. What their abstract and Xia et al.
// 2025 tell of it: light on the fibers is aggregated by dual scattering (Zinke et al. 2008); the number of fibers is a
// discrete parameter; the fibers' R lobe and the yarn's back lobe are uniform in azimuth. Fibers of that lineage
// (Khungurn et al. 2015) reflect F = C_R + (1 - C_R) (1 - |cos theta|)^5 and transmit (1 - F) C_TT. Everything else is
// our choice.
//
//   parameter    | unit            | default | differentiable
//   fiber_count  | >= 1            | 20      | no   fibers of the yarn
//   radius_ratio | 0 .. 1          | 0.15    | no   fiber radius / yarn radius; packing fiber_count radius_ratio^2
//   eta          | -               | 1.55    | yes  relative index of refraction: C_R = ((eta - 1) / (eta + 1))^2
//   sigma_a      | 1 / yarn radius | 0       | yes  absorption within fibers, RGB; per yarn radius as in thread.h
//   beta_r       | 0.02 .. 1       | 0.2     | yes  longitudinal roughness of a fiber's R (perceptual, as fibers')
//   beta_tt      | 0.02 .. 1       | 0.2     | yes  longitudinal roughness of a fiber's TT
//   gamma_tt     | 0.02 .. 1       | 0.3     | yes  azimuthal roughness of a fiber's TT
//
// A ray at offset h meets n(h) = (4 / pi) fiber_count radius_ratio sqrt(1 - h^2) fibers, rounded and at least one
// (threads are taken as opaque here too). There are three lobes; f_cos is as in lobes.h:
//
//   R        light that the outermost fiber reflects, uniform in azimuth, variance v_R; its energy F leaves the yarn
//   forward  light that passes the outermost fiber by TT and is scattered forward by the others, around phi = pi; the
//            variances add up: n v_TT along the yarn and n s_TT^2 across
//   back     light that is turned back once or three times inside and leaves through the outermost fiber, uniform in
//            azimuth; it turns half way through on average, so that the variance is n v_TT + v_R
//
// The energies are those of disjoint paths through a row of n fibers, each of which scatters a_f = F / 2 + (1 - F) C_TT
// forward and a_b = F / 2 back. Their sum never exceeds 1; without absorption it stays below 1 by the light that turns
// twice or more than three times. As n grows without bound, the back lobe's sums become those of Zinke et al. C_TT is
// the transmittance along the chord at the root mean square of a fiber's offsets, which is at most 0.7 % off the mean
// chord.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <vector>

#include "renderer/scattering/lobes.h"

namespace renderer {

template <class S>
struct BasicYarnParameters {
  int fiber_count = 20;
  double radius_ratio = 0.15;                              // fiber radius / yarn radius
  S eta = S(1.55);                                         // relative index of refraction
  Eigen::Matrix<S, 3, 1> sigma_a{S(0.0), S(0.0), S(0.0)};  // absorption per yarn radius, RGB
  S beta_r = S(0.2);                                       // longitudinal roughness of R, 0.02..1
  S beta_tt = S(0.2);                                      // longitudinal roughness of TT, 0.02..1
  S gamma_tt = S(0.3);                                     // azimuthal roughness of TT, 0.02..1
};
using YarnParameters = BasicYarnParameters<double>;

// The same parameters in another scalar.
template <class T, class S>
BasicYarnParameters<T> in_scalar(const BasicYarnParameters<S>& p) {
  return {p.fiber_count,
          p.radius_ratio,
          static_cast<T>(p.eta),
          p.sigma_a.template cast<T>(),
          static_cast<T>(p.beta_r),
          static_cast<T>(p.beta_tt),
          static_cast<T>(p.gamma_tt)};
}

// The number of fibers on the chord at offset h, at least 1.
inline int fibers_on_chord(int fiber_count, double radius_ratio, double h) {
  const double expected = 4 / std::numbers::pi * fiber_count * radius_ratio * std::sqrt(1 - h * h);
  return expected < 1.5 ? 1 : static_cast<int>(std::lround(expected));
}

// The energies of R, forward and back lobe of a row of n fibers, each with reflectance f and transmittance t.
template <class S>
std::array<S, 3> yarn_lobe_energies(int n, const S& f, const S& t) {
  const S through = (S(1.0) - f) * t, a_b = S(0.5) * f, a_f = a_b + through, round_trip = a_f * a_f;
  S forward = through, once(0.0), thrice(0.0);
  for (int k = 1; k < n; ++k) {  // one fiber more behind; once = 1 + q + ... + q^(k-1), q = round_trip
    forward *= a_f;
    once = S(1.0) + round_trip * once;
    thrice = round_trip * thrice + once * once;
  }
  return {f, forward, through * a_f * a_b * (once + a_b * a_b * thrice)};
}

// The model with everything computed that depends on the parameters but not on directions.
template <class S>
class YarnModel {
 public:
  explicit YarnModel(const BasicYarnParameters<S>& parameters) : parameters_(parameters) {
    using std::sqrt;
    const S v_r = longitudinal_variance(parameters.beta_r), v_tt = longitudinal_variance(parameters.beta_tt);
    const S s_tt = azimuthal_scale(parameters.gamma_tt);
    const int most = fibers_on_chord(parameters.fiber_count, parameters.radius_ratio, 0);
    for (int n = 1; n <= most; ++n) {
      LobeWidths<S>& widths = widths_.emplace_back();
      widths.set_uniform_azimuth(0, v_r);
      widths.set(1, S(n) * v_tt, S(std::sqrt(static_cast<double>(n))) * s_tt);
      widths.set_uniform_azimuth(2, S(n) * v_tt + v_r);
      widths.set(3, S(1.0), S(1.0));  // has no energy and is never sampled
    }
    const S root = (parameters.eta - S(1.0)) / (parameters.eta + S(1.0));
    normal_reflectance_ = root * root;
  }

  // The lobes seen from unit direction wo (local frame) at offset h in [-1, 1].
  CurveLobes<S> lobes_at(const Geometry<S>& h, const Vec3<Geometry<S>>& wo) const {
    using std::sqrt;
    using G = Geometry<S>;
    const G sin_o = wo.x(), cos_o = sqrt(wo.y() * wo.y() + wo.z() * wo.z());
    const int n = fibers_on_chord(parameters_.fiber_count, parameters_.radius_ratio, static_cast<double>(h));
    CurveLobes<S> lobes;
    lobes.widths = &widths_[static_cast<std::size_t>(n - 1)];
    lobes.set_azimuth(wo);
    lobes.sin_theta_o = Lanes<S>::Constant(S(sin_o));
    lobes.cos_theta_o = Lanes<S>::Constant(S(cos_o));
    lobes.center << S(0.0), S(std::numbers::pi), S(0.0), S(0.0);

    const S f = normal_reflectance_ + (S(1.0) - normal_reflectance_) * S(power(G(1 - cos_o), 5));
    const InnerChord<S> chord(G(std::sqrt(1.0 / 3)), sin_o, cos_o, parameters_.eta);
    const Rgb<S> transmittance = (parameters_.sigma_a.array() * (S(-parameters_.radius_ratio) * chord.length)).exp();
    for (int c = 0; c < 3; ++c) {
      const std::array<S, 3> energies = yarn_lobe_energies<S>(n, f, transmittance[c]);
      lobes.attenuation.col(c) << energies[0], energies[1], energies[2], S(0.0);
    }
    const Lanes<S> energy = lobes.attenuation.rowwise().sum();
    lobes.probability = energy / energy.sum();
    return lobes;
  }

 private:
  BasicYarnParameters<S> parameters_;
  std::vector<LobeWidths<S>> widths_;  // by number of fibers on the chord, from 1
  S normal_reflectance_;
};

}  // namespace renderer

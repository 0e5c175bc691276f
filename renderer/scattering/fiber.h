// Scattering of one dielectric fiber (Chiang et al. 2015): lobes R, TT, TRT and the remainder of all longer paths.
//
//   parameter | unit              | default | differentiable
//   eta       | -                 | 1.55    | yes   relative index of refraction
//   sigma_a   | 1 / fiber radius  | 0       | yes   absorption, RGB
//   beta_m    | 0.02 .. 1         | 0.3     | yes   longitudinal roughness (perceptual)
//   beta_n    | 0.02 .. 1         | 0.3     | yes   azimuthal roughness (perceptual)
//   tilt_rad  | rad               | 0       | yes   cuticle tilt; textile fibers have none
//
// f_cos includes the cosine (lobes.h). theta, h and the attenuations belong to the known direction o; the model is not
// exactly reciprocal. Without absorption the attenuations sum to 1 for every h and theta. A tilt turns theta_o by -2,
// +1 and +4 times itself for R, TT and TRT. Deviations from pbrt-v4's implementation of the same model: the Bessel
// function is accurate, and the sampling of the lobes does not cut their tails.
#pragma once

#include <Eigen/Core>
#include <cmath>

#include "renderer/scattering/lobes.h"

namespace renderer {

template <class S>
struct BasicFiberParameters {
  S eta = S(1.55);                                         // relative index of refraction
  Eigen::Matrix<S, 3, 1> sigma_a{S(0.0), S(0.0), S(0.0)};  // absorption per fiber radius, RGB
  S beta_m = S(0.3);                                       // longitudinal roughness, 0.02..1
  S beta_n = S(0.3);                                       // azimuthal roughness, 0.02..1
  S tilt_rad = S(0.0);                                     // cuticle tilt
};
using FiberParameters = BasicFiberParameters<double>;

// The same parameters in another scalar.
template <class T, class S>
BasicFiberParameters<T> in_scalar(const BasicFiberParameters<S>& p) {
  return {static_cast<T>(p.eta), p.sigma_a.template cast<T>(), static_cast<T>(p.beta_m), static_cast<T>(p.beta_n),
          static_cast<T>(p.tilt_rad)};
}

// The attenuations A_p of the four lobes (rows R, TT, TRT, remainder) from the Fresnel reflectance f and the
// transmittance t along one inner chord.
template <class S>
Eigen::Array<S, 4, 3> fiber_attenuation(const S& f, const Rgb<S>& t) {
  Eigen::Array<S, 4, 3> a;
  for (int c = 0; c < 3; ++c) {
    const S tf = t[c] * f;
    const S through = (S(1.0) - f) * (S(1.0) - f) * t[c];
    const S left = (S(1.0) - f) + f * (S(1.0) - t[c]);  // 1 - tf without cancellation; zero only where `through` is
    a(0, c) = f;
    a(1, c) = through;
    a(2, c) = through * tf;
    a(3, c) = left > S(1e-30) ? S(through * tf * tf / left) : S(0.0);
  }
  return a;
}

// The model with everything computed that depends on the parameters but not on directions.
template <class S>
class FiberModel {
 public:
  explicit FiberModel(const BasicFiberParameters<S>& parameters)
      : eta_(parameters.eta), sigma_a_(parameters.sigma_a.array()) {
    using std::cos, std::sin;
    const S v = longitudinal_variance(parameters.beta_m), s = azimuthal_scale(parameters.beta_n);
    widths_.set(0, v, s);
    widths_.set(1, S(0.25) * v, s);
    widths_.set(2, S(4.0) * v, s);
    widths_.set_uniform_azimuth(3, S(4.0) * v);
    const S turns[4] = {S(-2.0) * parameters.tilt_rad, parameters.tilt_rad, S(4.0) * parameters.tilt_rad, S(0.0)};
    for (int p = 0; p < 4; ++p) {
      cos_turn_[p] = cos(turns[p]);
      sin_turn_[p] = sin(turns[p]);
    }
  }

  // The lobes seen from unit direction wo (local frame) at offset h = sin(gamma_o) in [-1, 1].
  CurveLobes<S> lobes_at(const Geometry<S>& h, const Vec3<Geometry<S>>& wo) const {
    using std::asin, std::sqrt;
    const Geometry<S> sin_o = wo.x(), cos_o = sqrt(wo.y() * wo.y() + wo.z() * wo.z());
    CurveLobes<S> lobes;
    lobes.widths = &widths_;
    lobes.set_azimuth(wo);
    lobes.sin_theta_o = cos_turn_ * S(sin_o) + sin_turn_ * S(cos_o);
    lobes.cos_theta_o = (cos_turn_ * S(cos_o) - sin_turn_ * S(sin_o)).abs();

    const InnerChord<S> chord(h, sin_o, cos_o, eta_);
    for (int p = 0; p < 3; ++p) lobes.center[p] = lobe_center<S>(p, S(asin(h)), chord.gamma_t);
    lobes.center[3] = S(0.0);

    const Geometry<S> cos_gamma_o = sqrt(1 - h * h);
    const Rgb<S> transmittance = (sigma_a_ * -chord.length).exp();
    lobes.attenuation = fiber_attenuation<S>(fresnel_dielectric<S>(S(cos_o * cos_gamma_o), eta_), transmittance);
    const Lanes<S> energy = lobes.attenuation.rowwise().sum();
    lobes.probability = energy / energy.sum();
    return lobes;
  }

  const LobeWidths<S>& widths() const { return widths_; }

 private:
  S eta_;
  Rgb<S> sigma_a_;
  LobeWidths<S> widths_;
  Lanes<S> cos_turn_, sin_turn_;
};

}  // namespace renderer

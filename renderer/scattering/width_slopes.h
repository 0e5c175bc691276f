// The widths of lobes together with the derivatives of the lobes' densities by these widths, in closed form [models of
// d'Eon 2011 and Chiang 2015, differentiated]:
//
//   dlogM/dv = D / 2v^2 - a/v (I1(a)/I0(a) - 1) - 1/v + 2 e^(-2/v) / (v^2 (1 - e^(-2/v))),   a = cos cos / v
//   dlogN/ds = (x/s^2) tanh(x/2s) - 1/s + (pi/s^2) / sinh(pi/s)
//
// with D the squared distance across the cone and x the distance from the lobe's centre.
#pragma once

#include <numbers>

#include "renderer/scattering/lobes.h"

namespace renderer {

// The derivatives d longitudinal_variance / d beta_m and d azimuthal_scale / d beta_n.
template <class S>
S longitudinal_variance_slope(const S& beta_m) {
  const S root = S(0.726) * beta_m + S(0.812) * beta_m * beta_m + S(3.7) * power(beta_m, 20);
  return S(2.0) * root * (S(0.726) + S(1.624) * beta_m + S(74.0) * power(beta_m, 19));
}
template <class S>
S azimuthal_scale_slope(const S& beta_n) {
  return S(std::sqrt(std::numbers::pi / 8)) * (S(0.265) + S(2.388) * beta_n + S(118.184) * power(beta_n, 21));
}

template <class S>
struct WidthSlopes {
  LobeWidths<S> widths;
  Lanes<S> m_constant, n_constant;  // the part of each derivative that does not depend on directions

  void set(int p, const S& variance, const S& scale) {
    using std::exp, std::sinh;
    widths.set(p, variance, scale);
    const S v = widths.v[p], s = widths.s[p], tail = exp(S(-2.0) / v);
    m_constant[p] = S(2.0) * tail / (v * v * (S(1.0) - tail)) - S(1.0) / v;
    const S turn = S(std::numbers::pi) / s;
    n_constant[p] = (turn < S(80.0) ? turn / (s * sinh(turn)) : S(0.0)) - S(1.0) / s;
  }
  // Makes lobe p uniform in azimuth; dlog_n() has no meaning for it then.
  void set_uniform_azimuth(int p, const S& variance) {
    set(p, variance, S(1.0));
    widths.set_uniform_azimuth(p, variance);
  }
  template <class T>
  WidthSlopes<T> cast() const {
    return {widths.template cast<T>(), lanes_in<T, S>(m_constant), lanes_in<T, S>(n_constant)};
  }

  Lanes<S> dlog_m(const LobeAngles<S>& at) const {
    const Lanes<S> a = at.cos_cos * widths.inv_v;
    return widths.inv_v * (S(0.5) * at.distance2 * widths.inv_v - bessel_i0e_log_slope(a)) + m_constant;
  }
  Lanes<S> dlog_n(const LobeAngles<S>& at) const {
    const Lanes<S> x = at.from_center * widths.inv_s;
    const Lanes<S> e = (-at.from_center * widths.inv_s).exp();  // as in N; tanh(x / 2) = (1 - e) / (1 + e)
    return x * widths.inv_s * (S(1.0) - e) / (S(1.0) + e) + n_constant;
  }
};

}  // namespace renderer

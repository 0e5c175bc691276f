// The modified Bessel function I0, scaled so that it never overflows: bessel_i0e(x) = exp(-x) I0(x), x >= 0, and the
// slope of its logarithm.
//
// Generic scalars (double, dual numbers): the power series up to x = 20 and the asymptotic series above, each summed
// until it no longer changes; relative error below 1e-14. Single precision (many floats at once, for rendering):
// Abramowitz and Stegun 9.8.1 to 9.8.4, relative error below 4e-7. (The ten-term series and the asymptote usual in hair
// renderers are off by up to 2 % around x = 12 and are not used.)
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <numbers>

#include "renderer/scattering/packet.h"

namespace renderer {

// The value of bessel_i0e as factor exp(-exponent), so that a caller who multiplies it by another exponential needs to
// compute only one.
template <class S>
struct ScaledBessel {
  S factor, exponent;

  S value() const {
    using std::exp;
    return factor * exp(-exponent);
  }
};

// exp(-x) I_order(x) for order 0 or 1.
template <int order, class S>
ScaledBessel<S> bessel_ie(const S& x) {
  using std::abs, std::sqrt;
  if (x < S(20.0)) {
    const S quarter = x * x * S(0.25);
    S term = order == 0 ? S(1.0) : x * S(0.5), sum = term;
    for (int k = 1; k < 100 && term > sum * S(1e-17); ++k) {
      term *= quarter * S(1.0 / (static_cast<double>(k) * (k + order)));
      sum += term;
    }
    return {sum, x};
  }
  const S eighth = S(0.125) / x;
  S term(1.0), sum(1.0);
  for (int k = 1; k < 40 && abs(term) > sum * S(1e-17); ++k) {
    const double odd = 2.0 * k - 1.0;
    term *= eighth * S((odd * odd - 4 * order * order) / k);
    sum += term;
  }
  return {sum / sqrt(x * S(2 * std::numbers::pi)), S(0.0)};
}

template <class S>
ScaledBessel<S> bessel_i0e(const S& x) {
  return bessel_ie<0>(x);
}

// d log bessel_i0e / d log x = x (I1(x) / I0(x) - 1), from 0 down to about -1/2.
template <class S>
S bessel_i0e_log_slope(const S& x) {
  return x * (bessel_ie<1>(x).value() / bessel_ie<0>(x).value() - S(1.0));
}

// Single precision: up to kBesselNear the polynomial is one of I0 in powers of (x / kBesselNear)^2, from there one of
// sqrt(x) bessel_i0e in powers of kBesselNear / x.
inline constexpr float kBesselNear = 3.75f;

template <int n>
Packet<n> i0_near(const Packet<n>& t) {
  return polynomial(t, 1.0f, 3.5156229f, 3.0899424f, 1.2067492f, 0.2659732f, 0.0360768f, 0.0045813f);
}

template <int n>
ScaledBessel<Packet<n>> bessel_i0e(const Packet<n>& x) {
  const Packet<n> ratio = x * (1 / kBesselNear), w = min(kBesselNear / x, 1.0f);
  const Packet<n> far = polynomial(w, 0.39894228f, 0.01328592f, 0.00225319f, -0.00157565f, 0.00916281f, -0.02057706f,
                                   0.02635537f, -0.01647633f, 0.00392377f);
  const auto is_near = x < kBesselNear;
  return {select(is_near, i0_near<n>(ratio * ratio), far * sqrt(w * (1 / kBesselNear))),
          select(is_near, x, Packet<n>(0.0f))};
}

// Single precision: below kBesselNear the slope comes from the polynomials of I0 and I1, above it from a polynomial of
// w that was fitted to the exact function by least squares; absolute error below 2e-6. (A quotient of both asymptotes
// would be off by 2e-7 times x.)
template <int n>
Packet<n> bessel_i0e_log_slope(const Packet<n>& x) {
  const Packet<n> ratio = x * (1 / kBesselNear), t = ratio * ratio, w = min(kBesselNear / x, 1.0f);
  const Packet<n> i1 =
      x * polynomial(t, 0.5f, 0.87890594f, 0.51498869f, 0.15084934f, 0.02658733f, 0.00301532f, 0.00032411f);
  const Packet<n> far = polynomial(w, -0.499999575f, -0.0333411241f, -0.00932847053f, 0.00501429215f, -0.0612043676f,
                                   0.189197499f, -0.310748975f, 0.234599886f, -0.0648003679f);
  return select(x < kBesselNear, x * (i1 / i0_near<n>(t) - 1.0f), far);
}

inline ScaledBessel<Eigen::Array4f> bessel_i0e(const Eigen::Array4f& x) {
  const ScaledBessel<Packet<4>> packet = bessel_i0e(Packet<4>::load(x.data()));
  ScaledBessel<Eigen::Array4f> lanes;
  packet.factor.store(lanes.factor.data());
  packet.exponent.store(lanes.exponent.data());
  return lanes;
}

inline Eigen::Array4f bessel_i0e_log_slope(const Eigen::Array4f& x) {
  Eigen::Array4f slope;
  bessel_i0e_log_slope(Packet<4>::load(x.data())).store(slope.data());
  return slope;
}

// Arrays of other scalars are computed lane by lane.
template <class S, int n>
ScaledBessel<Eigen::Array<S, n, 1>> bessel_i0e(const Eigen::Array<S, n, 1>& x) {
  ScaledBessel<Eigen::Array<S, n, 1>> lanes;
  for (int lane = 0; lane < n; ++lane) {
    const ScaledBessel<S> one = bessel_i0e(x[lane]);
    lanes.factor[lane] = one.factor;
    lanes.exponent[lane] = one.exponent;
  }
  return lanes;
}

template <class S, int n>
Eigen::Array<S, n, 1> bessel_i0e_log_slope(const Eigen::Array<S, n, 1>& x) {
  Eigen::Array<S, n, 1> slope;
  for (int lane = 0; lane < n; ++lane) slope[lane] = bessel_i0e_log_slope(x[lane]);
  return slope;
}

}  // namespace renderer

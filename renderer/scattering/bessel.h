// The modified Bessel function I0, scaled so that it never overflows: bessel_i0e(x) = exp(-x) I0(x), x >= 0.
//
// Generic scalars (double, dual numbers): the power series up to x = 20 and the asymptotic series above, each summed
// until it no longer changes; relative error below 1e-14. Four floats at once, for rendering: Abramowitz and Stegun
// 9.8.1 to 9.8.4, relative error below 4e-7. (The ten-term series and the asymptote usual in hair renderers are off
// by up to 2 % around x = 12 and are not used.)
#pragma once

#include <Eigen/Core>
#include <cmath>

namespace renderer {

// exp(-x) I_order(x) for order 0 or 1.
template <int order, class S>
S bessel_ie(const S& x) {
  using std::abs, std::exp, std::sqrt;
  constexpr double kPi = 3.14159265358979323846;
  if (x < S(20.0)) {
    const S quarter = x * x * S(0.25);
    S term = order == 0 ? S(1.0) : x * S(0.5), sum = term;
    for (int k = 1; k < 100 && term > sum * S(1e-17); ++k) {
      term *= quarter * S(1.0 / (static_cast<double>(k) * (k + order)));
      sum += term;
    }
    return exp(-x) * sum;
  }
  const S eighth = S(0.125) / x;
  S term(1.0), sum(1.0);
  for (int k = 1; k < 40 && abs(term) > sum * S(1e-17); ++k) {
    const double odd = 2.0 * k - 1.0;
    term *= eighth * S((odd * odd - 4 * order * order) / k);
    sum += term;
  }
  return sum / sqrt(x * S(2 * kPi));
}

template <class S>
S bessel_i0e(const S& x) {
  return bessel_ie<0>(x);
}

template <class S>
Eigen::Array<S, 4, 1> bessel_i0e(const Eigen::Array<S, 4, 1>& x) {
  return {bessel_i0e(x[0]), bessel_i0e(x[1]), bessel_i0e(x[2]), bessel_i0e(x[3])};
}

inline Eigen::Array4f bessel_i0e(const Eigen::Array4f& x) {
  using A = Eigen::Array4f;
  const A t = (x * (1 / 3.75f)).square();
  const A near = 1 + t * (3.5156229f +
                          t * (3.0899424f + t * (1.2067492f + t * (0.2659732f + t * (0.0360768f + t * 0.0045813f)))));
  const A far_x = x.max(3.75f);
  const A w = 3.75f / far_x;
  const A far = 0.39894228f +
                w * (0.01328592f +
                     w * (0.00225319f +
                          w * (-0.00157565f +
                               w * (0.00916281f +
                                    w * (-0.02057706f + w * (0.02635537f + w * (-0.01647633f + w * 0.00392377f)))))));
  // Lanes above 3.75 clamp the first branch's argument implicitly by being discarded; exp(-x) only underflows to
  // zero.
  return (x < 3.75f).select(near * (-x).exp(), far * far_x.rsqrt());
}

// I1(x) / I0(x) - 1, what the logarithm of bessel_i0e grows by per unit of x.
template <class S>
Eigen::Array<S, 4, 1> log_bessel_i0e_slope(const Eigen::Array<S, 4, 1>& x) {
  Eigen::Array<S, 4, 1> slope;
  for (int lane = 0; lane < 4; ++lane) slope[lane] = bessel_ie<1>(x[lane]) / bessel_ie<0>(x[lane]) - S(1.0);
  return slope;
}

inline Eigen::Array4f log_bessel_i0e_slope(const Eigen::Array4f& x) {
  using A = Eigen::Array4f;
  const A t = (x * (1 / 3.75f)).square();
  const A near =
      x *
      (0.5f + t * (0.87890594f +
                   t * (0.51498869f + t * (0.15084934f + t * (0.02658733f + t * (0.00301532f + t * 0.00032411f))))));
  const A far_x = x.max(3.75f);
  const A w = 3.75f / far_x;
  const A far = 0.39894228f +
                w * (-0.03988024f +
                     w * (-0.00362018f +
                          w * (0.00163801f +
                               w * (-0.01031555f +
                                    w * (0.02282967f + w * (-0.02895312f + w * (0.01787654f - w * 0.00420059f)))))));
  const A i1e = (x < 3.75f).select(near * (-x).exp(), far * far_x.rsqrt());
  return i1e / bessel_i0e(x) - 1;
}

}  // namespace renderer

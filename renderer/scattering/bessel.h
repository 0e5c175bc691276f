// The modified Bessel function I0, scaled so that it never overflows: bessel_i0e(x) = exp(-x) I0(x), x >= 0.
//
// Generic scalars (double, dual numbers): the power series up to x = 20 and the asymptotic series above, each summed
// until it no longer changes; relative error below 1e-14. Four floats at once, for rendering: Abramowitz and Stegun
// 9.8.1 and 9.8.2, relative error below 4e-7. (The ten-term series and the asymptote usual in hair renderers are off
// by up to 2 % around x = 12 and are not used.)
#pragma once

#include <Eigen/Core>
#include <cmath>

namespace renderer {

template <class S>
S bessel_i0e(const S& x) {
  using std::exp, std::sqrt;
  constexpr double kPi = 3.14159265358979323846;
  S term(1.0), sum(1.0);
  if (x < S(20.0)) {
    const S quarter = x * x * S(0.25);
    for (int k = 1; k < 100 && term > sum * S(1e-17); ++k) {
      term *= quarter * S(1.0 / (static_cast<double>(k) * k));
      sum += term;
    }
    return exp(-x) * sum;
  }
  const S eighth = S(0.125) / x;
  for (int k = 1; k < 40 && term > sum * S(1e-17); ++k) {
    const double odd = 2.0 * k - 1.0;
    term *= eighth * S(odd * odd / k);
    sum += term;
  }
  return sum / sqrt(x * S(2 * kPi));
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

}  // namespace renderer

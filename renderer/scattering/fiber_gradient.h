// The fiber model's f_cos together with its derivatives by absorption and roughness, in closed form. The index of
// refraction is fixed and there is no tilt. Attenuations come from fiber.h, densities and their derivatives from
// width_slopes.h.
#pragma once

#include <numbers>

#include "renderer/scattering/fiber.h"
#include "renderer/scattering/thread_gradient.h"
#include "renderer/scattering/width_slopes.h"

namespace renderer {

// The derivatives of one channel's f_cos in their order; the absorption is the channel's own, the roughnesses are
// shared.
enum FiberSlope { kFiberSlopeSigma, kFiberSlopeBetaM, kFiberSlopeBetaN, kFiberSlopeCount };

// What value and slopes at one point and one direction are made of.
template <class S>
struct FiberFactors {
  Eigen::Array<S, 4, 3> attenuation, by_sigma;  // rows R, TT, TRT, remainder
  Eigen::Array<S, 4, 1> density, by_beta_m, by_beta_n;
};

// The fiber model for value and slopes; it is used in two steps like ThreadGradientModel (thread_gradient.h).
template <class S>
class FiberGradientModel {
 public:
  static constexpr int kSlopeCount = kFiberSlopeCount;
  using Factors = FiberFactors<S>;

  explicit FiberGradientModel(const BasicFiberParameters<S>& p)
      : eta_(p.eta),
        sigma_a_(p.sigma_a.array()),
        dv_(longitudinal_variance_slope(p.beta_m)),
        ds_(azimuthal_scale_slope(p.beta_n)) {
    const S v = longitudinal_variance(p.beta_m), s = azimuthal_scale(p.beta_n);
    widths_.set(0, v, s);
    widths_.set(1, S(0.25) * v, s);
    widths_.set(2, S(4.0) * v, s);
    if constexpr (kLanes < S >> 3) widths_.set(3, S(1.0), S(1.0));  // the remainder has lobe 2's M
  }
  template <class T>
  explicit FiberGradientModel(const FiberGradientModel<T>& other)
      : eta_(other.eta_),
        sigma_a_(other.sigma_a_.template cast<S>()),
        widths_(other.widths_.template cast<S>()),
        dv_(other.dv_),
        ds_(other.ds_) {}

  Factors factors(const ThreadPoint<S>& point, const LobeAngles<S>& at) const { return all_factors(point, at, false); }
  Factors slope_factors(const ThreadPoint<S>& point, const LobeAngles<S>& at) const {
    return all_factors(point, at, true);
  }

  Rgb<S> value(const Factors& f) const {
    Rgb<S> sum = Rgb<S>::Constant(S(0.0));
    for (int p = 0; p < 4; ++p)
      for (int c = 0; c < 3; ++c) sum[c] += f.density[p] * f.attenuation(p, c);
    return sum;
  }

  // Adds weight[channel] d f_cos[channel] / d parameter to slopes(row, channel).
  template <class Slopes>
  void add_slopes(const Factors& f, const Rgb<S>& weight, Slopes& slopes) const {
    for (int c = 0; c < 3; ++c)
      for (int p = 0; p < 4; ++p) {
        slopes(kFiberSlopeSigma, c) += weight[c] * f.density[p] * f.by_sigma(p, c);
        slopes(kFiberSlopeBetaM, c) += weight[c] * f.by_beta_m[p] * f.attenuation(p, c);
        slopes(kFiberSlopeBetaN, c) += weight[c] * f.by_beta_n[p] * f.attenuation(p, c);
      }
  }

 private:
  template <class>
  friend class FiberGradientModel;

  Factors all_factors(const ThreadPoint<S>& point, const LobeAngles<S>& at, bool slopes) const {
    Factors f;
    const S reflectance = fresnel(point);
    for (int c = 0; c < 3; ++c) {
      using std::exp;
      const S t = exp(-sigma_a_[c] * point.chord_length), tf = t * reflectance;
      const S entering = S(1.0) - reflectance, through = entering * entering * t;
      // 1 - tf without cancellation; where it vanishes, so does `through`.
      const S left = entering + reflectance * (S(1.0) - t) + S(1e-12);
      f.attenuation.col(c) << reflectance, through, through * tf, through * tf * tf / left;
      if (slopes)
        f.by_sigma.col(c) << S(0.0), -point.chord_length * f.attenuation(1, c),
            S(-2.0) * point.chord_length * f.attenuation(2, c),
            -point.chord_length * (S(3.0) + tf / left) * f.attenuation(3, c);
    }
    const Lanes<S> m = longitudinal_density(widths_.widths, at), n = azimuthal_density(widths_.widths, at);
    constexpr double kUniform = 0.5 / std::numbers::pi;
    f.density << m[0] * n[0], m[1] * n[1], m[2] * n[2], m[2] * S(kUniform);
    if (!slopes) return f;
    const Lanes<S> by_v = widths_.dlog_m(at), by_s = widths_.dlog_n(at);
    f.by_beta_m << f.density[0] * by_v[0] * dv_, f.density[1] * by_v[1] * S(0.25) * dv_,
        f.density[2] * by_v[2] * S(4.0) * dv_, f.density[3] * by_v[2] * S(4.0) * dv_;
    f.by_beta_n << f.density[0] * by_s[0] * ds_, f.density[1] * by_s[1] * ds_, f.density[2] * by_s[2] * ds_, S(0.0);
    return f;
  }

  // The Fresnel reflectance of the fiber at the point. The inner chord tells at which offset the fiber was met: sin^2
  // gamma_t = 1 - (chord cos theta_t / 2)^2, and (cos theta_o cos gamma_o)^2 = cos^2 theta_o - sin^2 gamma_t (eta^2 -
  // sin^2 theta_o).
  S fresnel(const ThreadPoint<S>& point) const {
    using std::sqrt, std::max, std::min;
    const S cos2 = point.cosine * point.cosine, eta2 = eta_ * eta_, bent = eta2 - S(1.0) + cos2;
    const S half = S(0.5) * point.chord_length, cos2_gamma = half * half * bent / eta2;
    const S cos2_i = max(S(0.0), cos2 - (S(1.0) - min(S(1.0), cos2_gamma)) * bent);
    const S cos_i = sqrt(min(S(1.0), cos2_i)), cos_t = sqrt(S(1.0) - (S(1.0) - min(S(1.0), cos2_i)) / eta2);
    const S parallel = (eta_ * cos_i - cos_t) / (eta_ * cos_i + cos_t);
    const S across = (cos_i - eta_ * cos_t) / (cos_i + eta_ * cos_t);
    return S(0.5) * (parallel * parallel + across * across);
  }

  S eta_;
  Rgb<S> sigma_a_;
  WidthSlopes<S> widths_;
  S dv_, ds_;
};

}  // namespace renderer

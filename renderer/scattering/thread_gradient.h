// The thread model's f_cos together with its derivatives by all 16 parameters, in closed form, and by
// the tint of R.
//
// The formula is the renderer's: values come from the densities of lobes.h and the energies of thread.h, derivatives of
// the densities from width_slopes.h. The energy limit of thread.h is left off, because fits penalise the excess
// instead. The options of thread.h count as constants.
#pragma once

#include "renderer/scattering/thread.h"
#include "renderer/scattering/width_slopes.h"

namespace renderer {

// The derivatives of one channel's f_cos in their order; the absorption and the tint are the channel's own, the
// others are shared by all channels.
enum ThreadSlope {
  kSlopeSigma = 0,
  kSlopeAlpha = 1,  // 3
  kSlopeBeta = 4,   // 3
  kSlopeR0 = 7,     // 3: r0a r0b r0c
  kSlopeR1 = 10,
  kSlopeR2 = 11,    // 3: r2a r2b r2c
  kSlopeTint = 14,  // lambda0_rgb
  kThreadSlopeCount = 15,
  kThreadSlopeLanes = 16  // padded with zeros
};

template <class S>
using ThreadSlopes = Eigen::Array<S, kThreadSlopeLanes, 3>;  // d f_cos[channel] / d parameter

template <class S>
struct ThreadGradient {
  Rgb<S> f_cos;
  ThreadSlopes<S> slopes;
};

// What stays the same for all directions at one point: c = |cos theta_o| and the length of the way through the thread
// in radii (InnerChord).
template <class S>
struct ThreadPoint {
  S cosine = S(0), chord_length = S(0);
};

// What value and slopes at one direction are made of.
template <class S>
struct ThreadFactors {
  ThreadPoint<S> point;
  std::array<S, 3> lambda;
  ThreadTransmittance<S> transmittance;
  Lanes<S> density;            // M N of each lobe
  Lanes<S> by_alpha, by_beta;  // and its derivatives
};

template <class S>
class ThreadGradientModel {
 public:
  static constexpr int kSlopeCount = kThreadSlopeCount;
  using Factors = ThreadFactors<S>;

  explicit ThreadGradientModel(const BasicThreadParameters<S>& parameters) : parameters_(parameters) {
    parameters_.limit_energy = false;
    for (int p = 0; p < 3; ++p) {
      const auto i = static_cast<std::size_t>(p);
      const S alpha = parameters.alpha[i], beta = parameters.beta[i];
      widths_.set(p, longitudinal_variance(alpha), azimuthal_scale(beta));
      dv_dalpha_[p] = longitudinal_variance_slope(alpha);
      ds_dbeta_[p] = azimuthal_scale_slope(beta);
    }
    widths_.set(3, S(1.0), S(1.0));
    dv_dalpha_[3] = ds_dbeta_[3] = S(0.0);
  }
  // The same model in another scalar.
  template <class T>
  explicit ThreadGradientModel(const ThreadGradientModel<T>& other)
      : parameters_(in_scalar<S>(other.parameters_)),
        widths_(other.widths_.template cast<S>()),
        dv_dalpha_(lanes_in<S, T>(other.dv_dalpha_)),
        ds_dbeta_(lanes_in<S, T>(other.ds_dbeta_)) {}

  ThreadGradient<S> evaluate(const ThreadPoint<S>& point, const LobeAngles<S>& at) const {
    const ThreadFactors<S> factors = slope_factors(point, at);
    ThreadGradient<S> gradient{value(factors), ThreadSlopes<S>::Zero()};
    add_slopes(factors, Rgb<S>::Ones(), gradient.slopes);
    return gradient;
  }

  // The value alone.
  Rgb<S> f_cos(const ThreadPoint<S>& point, const LobeAngles<S>& at) const { return value(factors(point, at)); }

  // The same in two steps, for callers that learn how much a direction counts only after its value: first the factors,
  // those of the value alone or those of the slopes too, then value() and add_slopes().
  ThreadFactors<S> factors(const ThreadPoint<S>& point, const LobeAngles<S>& at) const {
    return {.point = point,
            .lambda = thread_lobe_energies<S>(parameters_, point.cosine),
            .transmittance = thread_transmittance(parameters_, point.chord_length),
            .density = longitudinal_density(widths_.widths, at) * azimuthal_density(widths_.widths, at)};
  }
  ThreadFactors<S> slope_factors(const ThreadPoint<S>& point, const LobeAngles<S>& at) const {
    ThreadFactors<S> f = factors(point, at);
    f.by_alpha = f.density * widths_.dlog_m(at) * dv_dalpha_;
    f.by_beta = f.density * widths_.dlog_n(at) * ds_dbeta_;
    return f;
  }

  Rgb<S> value(const ThreadFactors<S>& f) const {
    return parameters_.lambda0_rgb.array() * (f.density[0] * f.lambda[0]) +
           f.transmittance.tt * (f.density[1] * f.lambda[1]) + f.transmittance.trt * (f.density[2] * f.lambda[2]);
  }

  // Adds weight[channel] d f_cos[channel] / d parameter to slopes(row, channel).
  template <class Slopes>
  void add_slopes(const Factors& f, const Rgb<S>& weight, Slopes& slopes) const {
    const S c = f.point.cosine, inverse = S(1.0) / (parameters_.r2a * c + parameters_.r2b);
    const auto power_tt = S(parameters_.transmittance_powers[0]), power_trt = S(parameters_.transmittance_powers[1]);
    for (int channel = 0; channel < 3; ++channel) {
      const S w0 = weight[channel] * parameters_.lambda0_rgb[channel],
              w1 = weight[channel] * f.transmittance.tt[channel], w2 = weight[channel] * f.transmittance.trt[channel];
      const S a0 = w0 * f.lambda[0], a1 = w1 * f.lambda[1], a2 = w2 * f.lambda[2];
      const S by_r0c = w0 * f.density[0], by_r2c = w2 * f.density[2], by_r2b = -by_r2c * inverse * inverse;
      auto slope = slopes.col(channel);
      slope[kSlopeSigma] -= f.point.chord_length * (power_tt * f.density[1] * a1 + power_trt * f.density[2] * a2);
      slope[kSlopeAlpha] += f.by_alpha[0] * a0;
      slope[kSlopeAlpha + 1] += f.by_alpha[1] * a1;
      slope[kSlopeAlpha + 2] += f.by_alpha[2] * a2;
      slope[kSlopeBeta] += f.by_beta[0] * a0;
      slope[kSlopeBeta + 1] += f.by_beta[1] * a1;
      slope[kSlopeBeta + 2] += f.by_beta[2] * a2;
      slope[kSlopeR0] += by_r0c * c * c;
      slope[kSlopeR0 + 1] += by_r0c * c;
      slope[kSlopeR0 + 2] += by_r0c;
      slope[kSlopeR1] += w1 * f.density[1] * c;
      slope[kSlopeR2] += by_r2b * c;
      slope[kSlopeR2 + 1] += by_r2b;
      slope[kSlopeR2 + 2] += by_r2c;
      slope[kSlopeTint] += weight[channel] * f.lambda[0] * f.density[0];
    }
  }

 private:
  template <class>
  friend class ThreadGradientModel;

  BasicThreadParameters<S> parameters_;
  WidthSlopes<S> widths_;
  Lanes<S> dv_dalpha_, ds_dbeta_;
};

}  // namespace renderer

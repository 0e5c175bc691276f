// The thread model's f_cos together with its derivatives with respect to all 16 parameters, in closed form.
//
// One formula with the renderer: values come from the densities of lobes.h and the energies of thread.h. Derivatives
// of the logarithms of M and N by variance v and scale s [models of d'Eon 2011 and Chiang 2015, differentiated]:
//
//   dlogM/dv = D / 2v^2 - a/v (I1(a)/I0(a) - 1) - 1/v + 2 e^(-2/v) / (v^2 (1 - e^(-2/v))),   a = cos cos / v
//   dlogN/ds = (x/s^2) tanh(x/2s) - 1/s + (pi/s^2) / sinh(pi/s)
//
// with D the squared distance across the cone and x the distance from the lobe's centre. The energy limit of thread.h
// is left off: fits penalise the excess instead (thread.h). The options of thread.h are constants here.
#pragma once

#include "renderer/scattering/thread.h"

namespace renderer {

// Of one channel, in this order; the absorption is the channel's own, the others are shared by all channels.
enum ThreadSlope {
  kSlopeSigma = 0,
  kSlopeAlpha = 1,  // 3
  kSlopeBeta = 4,   // 3
  kSlopeR0 = 7,     // 3: r0a r0b r0c
  kSlopeR1 = 10,
  kSlopeR2 = 11,  // 3: r2a r2b r2c
  kThreadSlopeCount = 14,
  kThreadSlopeLanes = 16  // padded with zeros
};

template <class S>
struct ThreadGradient {
  Rgb<S> f_cos;
  Eigen::Array<S, kThreadSlopeLanes, 3> slopes;  // d f_cos[channel] / d parameter
};

// What does not change from direction to direction at one point: c = |cos theta_o| and the way through the thread in
// radii (InnerChord).
template <class S>
struct ThreadPoint {
  S cosine = S(0), chord_length = S(0);
};

template <class S>
class ThreadGradientModel {
 public:
  explicit ThreadGradientModel(const BasicThreadParameters<S>& parameters)
      : parameters_(parameters),
        power_tt_(S(parameters.transmittance_powers[0])),
        power_trt_(S(parameters.transmittance_powers[1])) {
    using std::exp, std::sinh, std::sqrt;
    parameters_.limit_energy = false;
    for (int p = 0; p < 3; ++p) {
      const auto i = static_cast<std::size_t>(p);
      const S alpha = parameters.alpha[i], beta = parameters.beta[i];
      widths_.set(p, longitudinal_variance(alpha), azimuthal_scale(beta));
      const S v = widths_.v[p], s = widths_.s[p], tail = exp(S(-2.0) / v);
      dv_dalpha_[p] = S(2.0) * sqrt(v) * (S(0.726) + S(1.624) * alpha + S(74.0) * power(alpha, 19));
      ds_dbeta_[p] = S(std::sqrt(kPi / 8)) * (S(0.265) + S(2.388) * beta + S(118.184) * power(beta, 21));
      m_constant_[p] = S(2.0) * tail / (v * v * (S(1.0) - tail)) - S(1.0) / v;
      const S turn = S(kPi) / s;
      n_constant_[p] = (turn < S(80.0) ? turn / (s * sinh(turn)) : S(0.0)) - S(1.0) / s;
    }
    widths_.set(3, S(1.0), S(1.0));
    dv_dalpha_[3] = ds_dbeta_[3] = m_constant_[3] = n_constant_[3] = S(0.0);
  }

  ThreadGradient<S> evaluate(const ThreadPoint<S>& point, const LobeAngles<S>& at) const {
    const Lanes<S> density = longitudinal_density(widths_, at) * azimuthal_density(widths_, at);
    const Lanes<S> dalpha = density * dlog_m(at) * dv_dalpha_, dbeta = density * dlog_n(at) * ds_dbeta_;
    const S c = point.cosine;
    const std::array<S, 3> lambda = thread_lobe_energies<S>(parameters_, c);
    const ThreadTransmittance<S> transmittance(parameters_, point.chord_length);
    const S inverse = S(1.0) / (parameters_.r2a * c + parameters_.r2b), inverse2 = inverse * inverse;

    ThreadGradient<S> g;
    for (int channel = 0; channel < 3; ++channel) {
      const S tint = parameters_.lambda0_rgb[channel], t1 = transmittance.tt[channel],
              t2 = transmittance.trt[channel];
      const S a0 = lambda[0] * tint, a1 = lambda[1] * t1, a2 = lambda[2] * t2;
      const S through = density[1] * a1, inside = density[2] * a2, reflected = density[0] * tint;
      g.f_cos[channel] = density[0] * a0 + through + inside;
      auto slope = g.slopes.col(channel);
      slope[kSlopeSigma] = -point.chord_length * (power_tt_ * through + power_trt_ * inside);
      slope[kSlopeAlpha] = dalpha[0] * a0;
      slope[kSlopeAlpha + 1] = dalpha[1] * a1;
      slope[kSlopeAlpha + 2] = dalpha[2] * a2;
      slope[kSlopeBeta] = dbeta[0] * a0;
      slope[kSlopeBeta + 1] = dbeta[1] * a1;
      slope[kSlopeBeta + 2] = dbeta[2] * a2;
      slope[kSlopeR0] = reflected * c * c;
      slope[kSlopeR0 + 1] = reflected * c;
      slope[kSlopeR0 + 2] = reflected;
      slope[kSlopeR1] = density[1] * t1 * c;
      slope[kSlopeR2] = -density[2] * t2 * c * inverse2;
      slope[kSlopeR2 + 1] = -density[2] * t2 * inverse2;
      slope[kSlopeR2 + 2] = density[2] * t2;
      slope[14] = slope[15] = S(0.0);
    }
    return g;
  }

  // The value alone.
  Rgb<S> f_cos(const ThreadPoint<S>& point, const LobeAngles<S>& at) const {
    const Lanes<S> density = longitudinal_density(widths_, at) * azimuthal_density(widths_, at);
    const std::array<S, 3> lambda = thread_lobe_energies<S>(parameters_, point.cosine);
    const ThreadTransmittance<S> transmittance(parameters_, point.chord_length);
    return parameters_.lambda0_rgb.array() * (density[0] * lambda[0]) + transmittance.tt * (density[1] * lambda[1]) +
           transmittance.trt * (density[2] * lambda[2]);
  }

 private:
  Lanes<S> dlog_m(const LobeAngles<S>& at) const {
    const Lanes<S> a = at.cos_cos * widths_.inv_v;
    return widths_.inv_v * (S(0.5) * at.distance2 * widths_.inv_v - bessel_i0e_log_slope(a)) + m_constant_;
  }
  Lanes<S> dlog_n(const LobeAngles<S>& at) const {
    const Lanes<S> x = at.from_center * widths_.inv_s;
    const Lanes<S> e = (-x).exp();  // tanh(x / 2) = (1 - e) / (1 + e)
    return x * widths_.inv_s * (S(1.0) - e) / (S(1.0) + e) + n_constant_;
  }

  BasicThreadParameters<S> parameters_;
  S power_tt_, power_trt_;
  LobeWidths<S> widths_;
  Lanes<S> dv_dalpha_, ds_dbeta_, m_constant_, n_constant_;
};

}  // namespace renderer

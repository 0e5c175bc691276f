// The yarn baseline's f_cos together with its derivatives by absorption and roughness, in closed form except for the
// energies, which are dual numbers. The number of fibers and the index of refraction are fixed. Energies come from
// yarn.h, densities and their derivatives from width_slopes.h.
//
// ThreadPoint's second member, chord_length, is the number of fibers on the chord here.
#pragma once

#include <ceres/jet.h>

#include "renderer/scattering/thread_gradient.h"
#include "renderer/scattering/width_slopes.h"
#include "renderer/scattering/yarn.h"

namespace renderer {

// The derivatives of one channel's f_cos in their order; the absorption is the channel's own, the others are shared.
enum YarnSlope { kYarnSlopeSigma, kYarnSlopeBetaR, kYarnSlopeBetaTt, kYarnSlopeGammaTt, kYarnSlopeCount };

// What value and slopes at one point and one direction are made of.
template <class S>
struct YarnFactors {
  Eigen::Array<S, 3, 3> energy, by_sigma;  // rows R, forward, back
  Eigen::Array<S, 3, 1> density, by_beta_r, by_beta_tt, by_gamma_tt;
};

// The yarn model for value and slopes; it is used in two steps like ThreadGradientModel (thread_gradient.h). S is float
// or double.
template <class S>
class YarnGradientModel {
 public:
  static constexpr int kSlopeCount = kYarnSlopeCount;
  using Factors = YarnFactors<S>;

  explicit YarnGradientModel(const BasicYarnParameters<S>& p) : parameters_(p) {
    const S v_r = longitudinal_variance(p.beta_r), v_tt = longitudinal_variance(p.beta_tt),
            s_tt = azimuthal_scale(p.gamma_tt);
    dv_r_ = longitudinal_variance_slope(p.beta_r), dv_tt_ = longitudinal_variance_slope(p.beta_tt);
    ds_tt_ = azimuthal_scale_slope(p.gamma_tt);
    const int most = fibers_on_chord(p.fiber_count, p.radius_ratio, 0);
    for (int n = 1; n <= most; ++n) {
      WidthSlopes<S>& widths = widths_.emplace_back();
      widths.set_uniform_azimuth(0, v_r);
      widths.set(1, S(n) * v_tt, std::sqrt(S(n)) * s_tt);
      widths.set_uniform_azimuth(2, S(n) * v_tt + v_r);
      widths.set(3, S(1.0), S(1.0));
    }
    const S root = (p.eta - S(1.0)) / (p.eta + S(1.0));
    normal_reflectance_ = root * root;
  }

  Factors factors(const ThreadPoint<S>& point, const LobeAngles<S>& at) const { return slope_factors(point, at); }
  Factors slope_factors(const ThreadPoint<S>& point, const LobeAngles<S>& at) const {
    Factors f;
    const int n = std::clamp(static_cast<int>(point.chord_length + S(0.5)), 1, static_cast<int>(widths_.size()));
    set_energies(n, point.cosine, f);
    const WidthSlopes<S>& widths = widths_[static_cast<std::size_t>(n - 1)];
    f.density = (longitudinal_density(widths.widths, at) * azimuthal_density(widths.widths, at)).template head<3>();
    const Lanes<S> by_v = widths.dlog_m(at), by_s = widths.dlog_n(at);
    f.by_beta_r << f.density[0] * by_v[0] * dv_r_, S(0.0), f.density[2] * by_v[2] * dv_r_;
    f.by_beta_tt << S(0.0), f.density[1] * by_v[1] * S(n) * dv_tt_, f.density[2] * by_v[2] * S(n) * dv_tt_;
    f.by_gamma_tt << S(0.0), f.density[1] * by_s[1] * std::sqrt(S(n)) * ds_tt_, S(0.0);
    return f;
  }

  Rgb<S> value(const Factors& f) const { return (f.energy.transpose().matrix() * f.density.matrix()).array(); }

  // Adds weight[channel] d f_cos[channel] / d parameter to slopes(row, channel).
  template <class Slopes>
  void add_slopes(const Factors& f, const Rgb<S>& weight, Slopes& slopes) const {
    for (int c = 0; c < 3; ++c) {
      const auto& energy = f.energy.col(c);
      slopes(kYarnSlopeSigma, c) += weight[c] * (f.density * f.by_sigma.col(c)).sum();
      slopes(kYarnSlopeBetaR, c) += weight[c] * (f.by_beta_r * energy).sum();
      slopes(kYarnSlopeBetaTt, c) += weight[c] * (f.by_beta_tt * energy).sum();
      slopes(kYarnSlopeGammaTt, c) += weight[c] * (f.by_gamma_tt * energy).sum();
    }
  }

 private:
  void set_energies(int n, S cosine, Factors& f) const {
    using Jet = ceres::Jet<S, 1>;
    const S sine = std::sqrt(std::max(S(0.0), S(1.0) - cosine * cosine));
    const Jet reflectance(normal_reflectance_ + (S(1.0) - normal_reflectance_) * power(S(S(1.0) - cosine), 5));
    // The chord at the root mean square of a fiber's offsets, as in YarnModel.
    const S chord =
        S(parameters_.radius_ratio) * InnerChord<S>(S(std::sqrt(1.0 / 3)), sine, cosine, parameters_.eta).length;
    for (int c = 0; c < 3; ++c) {
      Jet through(std::exp(-parameters_.sigma_a[c] * chord));
      through.v[0] = -chord * through.a;
      const std::array<Jet, 3> energies = yarn_lobe_energies<Jet>(n, reflectance, through);
      for (int lobe = 0; lobe < 3; ++lobe) {
        f.energy(lobe, c) = energies[static_cast<std::size_t>(lobe)].a;
        f.by_sigma(lobe, c) = energies[static_cast<std::size_t>(lobe)].v[0];
      }
    }
  }

  BasicYarnParameters<S> parameters_;
  std::vector<WidthSlopes<S>> widths_;  // by number of fibers on the chord, from 1
  S normal_reflectance_, dv_r_, dv_tt_, ds_tt_;
};

}  // namespace renderer

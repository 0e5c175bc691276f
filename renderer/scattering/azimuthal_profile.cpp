#include "renderer/scattering/azimuthal_profile.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "renderer/scattering/lobes.h"

namespace renderer {
namespace {

using Eigen::ArrayXd;

// Offsets h = sin gamma at the middles of even steps of gamma over [0, pi/2]; the other half is the mirror image. A
// lobe's centre moves by at most 2 per radian of gamma, so that steps below half the logistic's scale, or below a fifth
// of a bin of 2 degrees, leave nothing to see (below 1e-4 of the peak; the test compares with 20 000 offsets).
int offsets_for(double scale) {
  return std::clamp(static_cast<int>(2 * std::numbers::pi / scale), 40, 300);
}

// Sums of logistics over bins of azimuth. The trimmed logistic's distribution function is
// 1/2 + tanh(x / 2s) / (2 tanh(pi / 2s)) over [-pi, pi] around its centre; a bin's share is its difference.
class LogisticBins {
 public:
  LogisticBins(double scale, int bins)
      : density(ArrayXd::Zero(bins)),
        by_scale(ArrayXd::Zero(bins)),
        bins_(bins),
        half_(0.5 / scale),
        whole_(std::tanh(std::numbers::pi * half_)),
        whole_slope_(2 * std::numbers::pi * half_ * half_ * (1 - whole_ * whole_)) {}

  void add(double center, double weight) {
    const ArrayXd straight = ArrayXd::LinSpaced(bins_ + 1, -std::numbers::pi, std::numbers::pi) - center;
    const ArrayXd x = straight - 2 * std::numbers::pi * (straight / (2 * std::numbers::pi)).round();
    // With e = exp(-|x| / s): tanh(|x| / 2s) = (1 - e) / (1 + e); its derivative by its argument is 4 e / (1 + e)^2.
    const ArrayXd e = (-2 * half_ * x.abs()).exp();
    const ArrayXd tanh = x.sign() * (1 - e) / (1 + e);
    const ArrayXd slope = (tanh * (whole_slope_ / whole_) - 8 * half_ * half_ * x * e / (1 + e).square()) / whole_;
    const double scaled = 0.5 * weight * bins_ / (2 * std::numbers::pi);
    const ArrayXd share = (tanh.tail(bins_) - tanh.head(bins_)) / whole_;
    density += scaled * (share < -1).select(share + 2, share);  // the bin where x jumps from pi to -pi
    by_scale += scaled * (slope.tail(bins_) - slope.head(bins_));
  }

  ArrayXd density, by_scale;

 private:
  int bins_;
  double half_, whole_, whole_slope_;  // 1 / 2s; tanh(pi / 2s) and minus its derivative by s
};

}  // namespace

AzimuthalProfile azimuthal_profile(int p, double theta_rad, double eta, double scale, double sigma_a, int bins) {
  const double sin_theta = std::sin(theta_rad), cos_theta = std::cos(theta_rad);
  LogisticBins sum(scale, bins);
  LogisticBins dimmed(scale, bins);  // weighted with the way inside, for the derivative by absorption
  const int offsets = offsets_for(scale);
  const double step = std::numbers::pi / 2 / offsets;
  for (int i = 0; i < offsets; ++i) {
    const double gamma = (i + 0.5) * step, weight = 2 * std::sin(step / 2) * std::cos(gamma);  // the exact width in h
    const InnerChord<double> chord(std::sin(gamma), sin_theta, cos_theta, eta);
    const double transmittance = p == 0 ? 1 : std::exp(-sigma_a * chord.length);
    const double center = lobe_center<double>(p, gamma, chord.gamma_t);
    sum.add(center, transmittance * weight);
    if (p > 0 && sigma_a > 0) dimmed.add(center, -chord.length * transmittance * weight);
  }
  const auto both_sides = [](const ArrayXd& half) { return ArrayXd(0.5 * (half + half.reverse())); };
  return {both_sides(sum.density), both_sides(sum.by_scale), both_sides(dimmed.density)};
}

AzimuthalProfile logistic_profile(double center, double scale, int bins) {
  LogisticBins sum(scale, bins);
  sum.add(center, 1);
  return {sum.density, sum.by_scale, ArrayXd::Zero(bins)};
}

ArrayXd smooth_fiber_lobe(int p, double theta_rad, double eta, double sigma_a, int bins) {
  constexpr int kOffsets = 400000;  // many per bin: caustics gather them, other bins must not be starved
  const double sin_theta = std::sin(theta_rad), cos_theta = std::cos(theta_rad);
  ArrayXd density = ArrayXd::Zero(bins);
  for (int i = 0; i < kOffsets; ++i) {
    const double h = 2 * (i + 0.5) / kOffsets - 1;
    const InnerChord<double> chord(h, sin_theta, cos_theta, eta);
    const double f = fresnel_dielectric(cos_theta * std::sqrt(1 - h * h), eta);
    const double t = std::exp(-sigma_a * chord.length);
    const double energy = p == 0 ? f : (1 - f) * (1 - f) * t * std::pow(f * t, p - 1);
    const double phi = lobe_center<double>(p, std::asin(h), chord.gamma_t);
    const auto bin = static_cast<Eigen::Index>((phi + std::numbers::pi) / (2 * std::numbers::pi) * bins);
    density[std::min<Eigen::Index>(bin, bins - 1)] += energy;
  }
  return density * (bins / (2 * std::numbers::pi * kOffsets));
}

}  // namespace renderer

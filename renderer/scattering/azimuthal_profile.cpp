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
        dimmed(ArrayXd::Zero(bins)),
        bins_(bins),
        bin_(2 * std::numbers::pi / static_cast<double>(bins)),
        half_(0.5 / scale),
        whole_(std::tanh(std::numbers::pi * half_)),
        whole_slope_(2 * std::numbers::pi * half_ * half_ * (1 - whole_ * whole_)),
        ramp_(bin_ * ArrayXd::LinSpaced(bins, 0, static_cast<double>(bins - 1))),
        fall_((-2 * half_ * ramp_).exp()),
        e_(bins),
        tanh_(bins),
        slope_(bins),
        share_(bins) {}

  // Adds a logistic: `weight` of it to density and by_scale, `dimmed_weight` to dimmed.
  void add(double center, double weight, double dimmed_weight) {
    // Edges of bins in the order of x, their angle from the centre: those below it, then those above, none beyond pi.
    const double bins = static_cast<double>(bins_);
    double place = (center + std::numbers::pi) / bin_;
    place -= bins * std::floor(place / bins);
    const double next = std::floor(place) + 1;  // the first edge above
    const Eigen::Index above = static_cast<Eigen::Index>(0.5 * bins - (next - place)) + 1, below = bins_ - above;
    const double lowest = (next - place - static_cast<double>(below)) * bin_;
    // With e = exp(-|x| / s), which falls by the same factor from edge to edge: tanh(|x| / 2s) = (1 - e) / (1 + e); its
    // derivative by its argument is 4 e / (1 + e)^2.
    e_.head(below) = std::exp(-2 * half_ * bin_ * (place - next + 1)) * fall_.head(below).reverse();
    e_.tail(above) = std::exp(-2 * half_ * bin_ * (next - place)) * fall_.head(above);
    slope_ = 1 / (1 + e_);
    tanh_ = (1 - e_) * slope_;
    tanh_.head(below) *= -1;
    slope_ = (whole_slope_ / whole_) * tanh_ - 8 * half_ * half_ * (lowest + ramp_) * e_ * slope_.square();

    const double unit = 0.5 / (bin_ * whole_);
    const Eigen::Index first = (static_cast<Eigen::Index>(next) - below + bins_) % bins_;
    set_shares(tanh_, 2 * whole_);
    add_shares(density, unit * weight, first);
    if (dimmed_weight != 0) add_shares(dimmed, unit * dimmed_weight, first);
    set_shares(slope_, 0);
    add_shares(by_scale, unit * weight, first);
  }

  ArrayXd density, by_scale, dimmed;

 private:
  // What each bin has of a function of its edges that rises by `around` from the last of them to the first.
  void set_shares(const ArrayXd& at_edges, double around) {
    share_.head(bins_ - 1) = at_edges.tail(bins_ - 1) - at_edges.head(bins_ - 1);
    share_[bins_ - 1] = at_edges[0] - at_edges[bins_ - 1] + around;
  }
  void add_shares(ArrayXd& sum, double weight, Eigen::Index first) const {
    sum.tail(bins_ - first) += weight * share_.head(bins_ - first);
    sum.head(first) += weight * share_.tail(first);
  }

  Eigen::Index bins_;
  double bin_, half_, whole_, whole_slope_;  // width of a bin; 1 / 2s; tanh(pi / 2s) and minus its derivative by s
  ArrayXd ramp_, fall_;                      // multiples of a bin, and e at them
  ArrayXd e_, tanh_, slope_, share_;         // of add()
};

}  // namespace

AzimuthalProfile azimuthal_profile(int p, double theta_rad, double eta, double scale, double sigma_a, int bins) {
  const double sin_theta = std::sin(theta_rad), cos_theta = std::cos(theta_rad);
  LogisticBins sum(scale, bins);
  const int offsets = offsets_for(scale);
  const double step = std::numbers::pi / 2 / offsets;
  for (int i = 0; i < offsets; ++i) {
    const double gamma = (i + 0.5) * step, weight = 2 * std::sin(step / 2) * std::cos(gamma);  // the exact width in h
    const InnerChord<double> chord(std::sin(gamma), sin_theta, cos_theta, eta);
    const double transmittance = p == 0 ? 1 : std::exp(-sigma_a * chord.length);
    const double center = lobe_center<double>(p, gamma, chord.gamma_t);
    // The second weight goes with the way inside, for the derivative by absorption.
    sum.add(center, transmittance * weight, p > 0 && sigma_a > 0 ? -chord.length * transmittance * weight : 0);
  }
  const auto both_sides = [](const ArrayXd& half) { return ArrayXd(0.5 * (half + half.reverse())); };
  return {both_sides(sum.density), both_sides(sum.by_scale), both_sides(sum.dimmed)};
}

AzimuthalProfile logistic_profile(double center, double scale, int bins) {
  LogisticBins sum(scale, bins);
  sum.add(center, 1, 0);
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

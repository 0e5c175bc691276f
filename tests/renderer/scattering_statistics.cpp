#include "scattering_statistics.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <vector>

namespace renderer {
namespace {

constexpr int kSine = 14, kAzimuth = 24;  // bins of sin theta and of phi

Vec3<double> draw(const CurveLobes<double>& lobes, std::mt19937_64& engine) {
  std::uniform_real_distribution<double> uniform(0, 1);
  const double a = uniform(engine), b = uniform(engine), c = uniform(engine), d = uniform(engine);
  return lobes.sample(a, b, c, d);
}

int bin_of(const Vec3<double>& w) {
  const int i = std::clamp(static_cast<int>((w.x() + 1) / 2 * kSine), 0, kSine - 1);
  const int j = std::clamp(static_cast<int>((std::atan2(w.z(), w.y()) / kPi + 1) / 2 * kAzimuth), 0, kAzimuth - 1);
  return i * kAzimuth + j;
}

// Integral of the density over each bin; sin theta and phi are an equal-area map, so the measure is constant.
std::vector<double> bin_probabilities(const CurveLobes<double>& lobes) {
  constexpr int kPanels = 6;
  constexpr std::array<double, 3> kNode{0.1127016653792583, 0.5, 0.8872983346207417};  // Gauss-Legendre on [0, 1]
  constexpr std::array<double, 3> kWeight{5.0 / 18, 8.0 / 18, 5.0 / 18};
  const int rows = kSine * kPanels, columns = kAzimuth * kPanels;
  std::vector<double> probability(kSine * kAzimuth, 0);
  for (int i = 0; i < rows * 3; ++i) {
    const double x = 2 * (i / 3 + kNode[static_cast<std::size_t>(i % 3)]) / rows - 1, cosine = std::sqrt(1 - x * x);
    for (int j = 0; j < columns * 3; ++j) {
      const double phi = kPi * (2 * (j / 3 + kNode[static_cast<std::size_t>(j % 3)]) / columns - 1);
      const Vec3<double> w(x, cosine * std::cos(phi), cosine * std::sin(phi));
      const double area = kWeight[static_cast<std::size_t>(i % 3)] * kWeight[static_cast<std::size_t>(j % 3)] * 4 *
                          kPi / (rows * columns);
      probability[static_cast<std::size_t>(i / 3 / kPanels * kAzimuth + j / 3 / kPanels)] +=
          lobes.evaluate(w).pdf * area;
    }
  }
  return probability;
}

// Upper tail of the chi-square distribution, Wilson and Hilferty's approximation (error below 1e-3 for many degrees).
double chi_square_tail(double statistic, int degrees) {
  const double k = degrees, z = (std::cbrt(statistic / k) - (1 - 2 / (9 * k))) / std::sqrt(2 / (9 * k));
  return 0.5 * std::erfc(z / std::sqrt(2.0));
}

}  // namespace

Vec3<double> direction(double theta, double phi) {
  return {std::sin(theta), std::cos(theta) * std::cos(phi), std::cos(theta) * std::sin(phi)};
}

Vec3<double> viewing_direction(double theta, double h) {
  return direction(theta, kPi / 2 + std::asin(h));
}

// The lobes are products of a longitudinal and an azimuthal factor, so the integral over the sphere is one of sums.
double energy(const CurveLobes<double>& lobes, int channel) {
  constexpr int kSteps = 4000;  // a step is below the narrowest width of the grid below (0.0036 rad)
  Lanes<double> m = Lanes<double>::Zero(), n = Lanes<double>::Zero();
  for (int k = 0; k < kSteps; ++k) {
    const double theta = kPi * ((k + 0.5) / kSteps - 0.5), phi = 2 * kPi * (k + 0.5) / kSteps - kPi;
    const Eigen::Vector2d around(std::cos(phi), std::sin(phi));  // turned by phi from direction o
    const Eigen::Vector2d o = lobes.azimuth_o;
    const Vec3<double> in_plane(0, o.x() * around.x() - o.y() * around.y(), o.x() * around.y() + o.y() * around.x());
    m += longitudinal_density(*lobes.widths, lobes.angles(direction(theta, 0))) * (std::cos(theta) * kPi / kSteps);
    n += azimuthal_density(*lobes.widths, lobes.angles(in_plane)) * (2 * kPi / kSteps);
  }
  return (m * n * lobes.attenuation.col(channel)).sum();
}

double sampling_p_value(const CurveLobes<double>& lobes, int samples, std::uint64_t seed) {
  std::mt19937_64 engine(seed);
  std::vector<double> observed(kSine * kAzimuth, 0);
  for (int i = 0; i < samples; ++i) ++observed[static_cast<std::size_t>(bin_of(draw(lobes, engine)))];
  const std::vector<double> probability = bin_probabilities(lobes);
  double statistic = 0, pooled_expected = 0, pooled_observed = 0;
  int cells = 0;
  const auto add = [&](double expected, double found) {
    statistic += (found - expected) * (found - expected) / expected;
    ++cells;
  };
  for (std::size_t bin = 0; bin < observed.size(); ++bin) {
    const double expected = probability[bin] * samples;
    if (expected >= 5) {
      add(expected, observed[bin]);
    } else {  // rare bins are judged together
      pooled_expected += expected;
      pooled_observed += observed[bin];
    }
  }
  if (pooled_expected > 1) add(pooled_expected, pooled_observed);
  return chi_square_tail(statistic, cells - 1);
}

SampledMean sampled_albedo(const CurveLobes<double>& lobes, int samples, std::uint64_t seed) {
  std::mt19937_64 engine(seed);
  Rgb<double> sum = Rgb<double>::Zero(), square = Rgb<double>::Zero();
  for (int i = 0; i < samples; ++i) {
    const auto value = lobes.evaluate(draw(lobes, engine));
    const Rgb<double> weight = value.f_cos / value.pdf;
    sum += weight;
    square += weight.square();
  }
  const Rgb<double> mean = sum / samples;
  return {mean, ((square / samples - mean.square()).max(0.0) / samples).sqrt()};
}

}  // namespace renderer

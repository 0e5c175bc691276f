#include "tests/renderer/scattering/scattering_statistics.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <vector>

namespace renderer {
namespace {

constexpr int kCells = 4000;                      // a cell is below the narrowest width of any lobe (0.0036 rad)
constexpr std::size_t kRows = 14, kColumns = 24;  // quantiles of theta and of phi

Vec3<double> draw(const CurveLobes<double>& lobes, std::mt19937_64& engine) {
  std::uniform_real_distribution<double> uniform(0, 1);
  const double a = uniform(engine), b = uniform(engine), c = uniform(engine), d = uniform(engine);
  return lobes.sample(a, b, c, d);
}

// Direction turned by phi from direction o, across the curve.
Vec3<double> turned(const CurveLobes<double>& lobes, double phi) {
  const Eigen::Vector2d o = lobes.azimuth_o;
  return {0, o.x() * std::cos(phi) - o.y() * std::sin(phi), o.x() * std::sin(phi) + o.y() * std::cos(phi)};
}

double inclination_of(const Vec3<double>& w) {
  return std::atan2(w.x(), std::hypot(w.y(), w.z()));
}

double azimuth_of(const CurveLobes<double>& lobes, const Vec3<double>& w) {
  const Eigen::Vector2d o = lobes.azimuth_o;
  return std::atan2(o.x() * w.z() - o.y() * w.y(), o.x() * w.y() + o.y() * w.z());
}

double inclination_at(double cell) {
  return std::numbers::pi * (cell / kCells - 0.5);
}

double azimuth_at(double cell) {
  return std::numbers::pi * (2 * cell / kCells - 1);
}

// The lobes are products of a longitudinal and an azimuthal factor; each integrated over cells of its angle.
struct LobeIntegrals {
  std::vector<Lanes<double>> along, across;
};

LobeIntegrals lobe_integrals(const CurveLobes<double>& lobes) {
  LobeIntegrals integrals;
  for (int k = 0; k < kCells; ++k) {
    const double theta = inclination_at(k + 0.5);
    integrals.along.push_back(longitudinal_density(*lobes.widths, lobes.angles(direction(theta, 0))) *
                              (std::cos(theta) * std::numbers::pi / kCells));
    const Vec3<double> w = turned(lobes, azimuth_at(k + 0.5));
    integrals.across.push_back(azimuthal_density(*lobes.widths, lobes.angles(w)) * (2 * std::numbers::pi / kCells));
  }
  return integrals;
}

// Cells grouped into `count` bins of nearly equal probability: the first cell of each bin, then kCells.
std::vector<int> quantiles(const std::vector<Lanes<double>>& cells, const Lanes<double>& probability,
                           std::size_t count) {
  std::vector<int> first{0};
  double sum = 0;
  for (int k = 0; k < kCells; ++k) {
    sum += (cells[static_cast<std::size_t>(k)] * probability).sum();
    if (first.size() < count && sum >= static_cast<double>(first.size()) / static_cast<double>(count))
      first.push_back(k + 1);
  }
  first.resize(count, kCells);
  first.push_back(kCells);
  return first;
}

std::vector<Lanes<double>> binned(const std::vector<Lanes<double>>& cells, const std::vector<int>& first) {
  std::vector<Lanes<double>> bins(first.size() - 1, Lanes<double>::Zero());
  for (std::size_t bin = 0; bin < bins.size(); ++bin)
    for (int k = first[bin]; k < first[bin + 1]; ++k) bins[bin] += cells[static_cast<std::size_t>(k)];
  return bins;
}

std::size_t bin_of(double cell, const std::vector<int>& first) {
  const int whole = std::clamp(static_cast<int>(cell), 0, kCells - 1);
  return static_cast<std::size_t>(std::upper_bound(first.begin(), first.end(), whole) - first.begin()) - 1;
}

// Upper tail of the chi-square distribution, Wilson and Hilferty's approximation (error below 1e-3 for many degrees).
double chi_square_tail(double statistic, int degrees) {
  const double k = degrees, z = (std::cbrt(statistic / k) - (1 - 2 / (9 * k))) / std::sqrt(2 / (9 * k));
  return 0.5 * std::erfc(z / std::sqrt(2.0));
}

double chi_square_p_value(const std::vector<double>& observed, const std::vector<double>& expected) {
  double statistic = 0, rare_expected = 0, rare_observed = 0;
  int cells = 0;
  const auto add = [&](double wanted, double found) {
    statistic += (found - wanted) * (found - wanted) / wanted;
    ++cells;
  };
  for (std::size_t bin = 0; bin < observed.size(); ++bin) {
    if (expected[bin] >= 5) {
      add(expected[bin], observed[bin]);
    } else {  // rare bins are judged together
      rare_expected += expected[bin];
      rare_observed += observed[bin];
    }
  }
  if (rare_expected > 1) add(rare_expected, rare_observed);
  return chi_square_tail(statistic, cells - 1);
}

// A random number that chooses lobe p.
double choice_of(const CurveLobes<double>& lobes, int p) {
  return lobes.probability.head(p).sum() + lobes.probability[p] / 2;
}

}  // namespace

Vec3<double> direction(double theta, double phi) {
  return {std::sin(theta), std::cos(theta) * std::cos(phi), std::cos(theta) * std::sin(phi)};
}

Vec3<double> viewing_direction(double theta, double h) {
  return direction(theta, std::numbers::pi / 2 + std::asin(h));
}

Rgb<double> energy(const CurveLobes<double>& lobes) {
  const LobeIntegrals integrals = lobe_integrals(lobes);
  Lanes<double> m = Lanes<double>::Zero(), n = Lanes<double>::Zero();
  for (const Lanes<double>& cell : integrals.along) m += cell;
  for (const Lanes<double>& cell : integrals.across) n += cell;
  return lobes.attenuation.transpose().matrix() * (m * n).matrix();
}

double sampling_p_value(const CurveLobes<double>& lobes, int samples, std::uint64_t seed) {
  const LobeIntegrals integrals = lobe_integrals(lobes);
  const std::vector<int> rows = quantiles(integrals.along, lobes.probability, kRows),
                         columns = quantiles(integrals.across, lobes.probability, kColumns);
  const std::vector<Lanes<double>> m = binned(integrals.along, rows), n = binned(integrals.across, columns);
  std::vector<double> expected, observed(kRows * kColumns, 0);
  for (const Lanes<double>& row : m)
    for (const Lanes<double>& column : n) expected.push_back(samples * (row * column * lobes.probability).sum());

  std::mt19937_64 engine(seed);
  for (int i = 0; i < samples; ++i) {
    const Vec3<double> w = draw(lobes, engine);
    const std::size_t row = bin_of((inclination_of(w) / std::numbers::pi + 0.5) * kCells, rows),
                      column = bin_of((azimuth_of(lobes, w) / std::numbers::pi + 1) / 2 * kCells, columns);
    ++observed[row * kColumns + column];
  }
  return chi_square_p_value(observed, expected);
}

double azimuth_map_error(const CurveLobes<double>& lobes, int p) {
  constexpr double kStep = 1e-6;
  const double choice = choice_of(lobes, p);
  double worst = 0;
  for (double u : {0.001, 0.1, 0.3, 0.4999, 0.7, 0.95, 0.999}) {
    const auto phi = [&](double at) { return azimuth_of(lobes, lobes.sample(choice, 0.5, 0.25, at)); };
    const double slope = std::remainder(phi(u + kStep) - phi(u - kStep), 2 * std::numbers::pi) / (2 * kStep);
    const double density = azimuthal_density(*lobes.widths, lobes.angles(turned(lobes, phi(u))))[p];
    worst = std::max(worst, std::abs(density * slope - 1));
  }
  return worst;
}

double inclination_map_error(const CurveLobes<double>& lobes, int p) {
  constexpr int kSteps = 500;
  const double choice = choice_of(lobes, p);
  const std::vector<Lanes<double>> along = lobe_integrals(lobes).along;
  double below = 0, worst = 0;
  for (int k = 0; k < kCells; ++k) {
    const double before = below;
    below += along[static_cast<std::size_t>(k)][p];
    if (std::floor(before * 4) == std::floor(below * 4) || below > 0.99) continue;  // three limits along the cdf
    const double limit = std::sin(inclination_at(k + 1));
    // For each u_theta, sin theta falls monotonically while u_ring goes from 0 to 1/2, and rises on the way to 1.
    double probability = 0;
    for (int i = 0; i < kSteps; ++i) {
      double low = 0, high = 0.5;
      for (int halving = 0; halving < 20; ++halving) {
        const double middle = (low + high) / 2;
        (lobes.sample(choice, (i + 0.5) / kSteps, middle, 0.5).x() > limit ? low : high) = middle;
      }
      probability += (1 - 2 * low) / kSteps;
    }
    worst = std::max(worst, std::abs(probability - below));
  }
  return worst;
}

SampledMean sampled_albedo(const CurveLobes<double>& lobes, int samples, std::uint64_t seed) {
  std::mt19937_64 engine(seed);
  Rgb<double> sum = Rgb<double>::Zero(), square = Rgb<double>::Zero();
  SampledMean albedo{.least_weight = std::numeric_limits<double>::infinity(), .greatest_weight = 0};
  for (int i = 0; i < samples; ++i) {
    const auto value = lobes.evaluate(draw(lobes, engine));
    const Rgb<double> weight = value.f_cos / value.pdf;
    sum += weight;
    square += weight.square();
    albedo.least_weight = std::min(albedo.least_weight, weight.mean());
    albedo.greatest_weight = std::max(albedo.greatest_weight, weight.mean());
  }
  albedo.mean = sum / samples;
  albedo.standard_error = ((square / samples - albedo.mean.square()).max(0.0) / samples).sqrt();
  return albedo;
}

}  // namespace renderer

#include "renderer/scattering/tabulated.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "tests/renderer/scattering/scattering_statistics.h"

namespace renderer {
namespace {

// Small, but of real simulations.
const AzimuthalTable& table() {
  static const AzimuthalTable simulated = simulate_table({.rays = 500, .configurations = 12, .bins = 60});
  return simulated;
}

TEST(TabulatedTest, AtANodeItIsTheSimulation) {
  const double sigma = table().absorptions[5];
  const TabulatedModel model(table(), {.sigma_a = {0, sigma, sigma}, .alpha = 0.2});
  const MultiFiberScattering simulated = simulate_multi_fiber(
      {.sigma_a = sigma, .theta_rad = table().thetas_rad[7], .rays = 500, .configurations = 12, .bins = 60});
  const Rgb<double> albedo = model.lobes_at(0, viewing_direction(table().thetas_rad[7], 0)).albedo();
  EXPECT_NEAR(albedo[0], 1, 1e-9);
  EXPECT_NEAR(albedo[1], simulated.albedo, 1e-9);
}

TEST(TabulatedTest, BetweenNodesTheAlbedoIsNearThatOfASimulationThere) {
  const double sigma = 0.06, theta = 0.55;
  const TabulatedModel model(table(), {.sigma_a = {sigma, sigma, sigma}});
  const MultiFiberScattering simulated =
      simulate_multi_fiber({.sigma_a = sigma, .theta_rad = theta, .rays = 500, .configurations = 40, .seed = 9});
  // Linear interpolation over a ratio of 1.6 in absorption, and few rays: some percent.
  EXPECT_NEAR(model.lobes_at(0, viewing_direction(theta, 0)).albedo()[0], simulated.albedo, 0.03);
}

TEST(TabulatedTest, FurnaceIsTheAlbedoOfTheTableAndTheDensityIntegratesToOne) {
  const TabulatedModel model(table(), {.sigma_a = {0, 0.1, 1}, .alpha = 0.4});
  for (double theta : {-1.2, 0.0, 0.7}) {
    const TabulatedLobes lobes = model.lobes_at(0.3, viewing_direction(theta, 0.3));
    constexpr int kTheta = 400, kPhi = 600;
    Rgb<double> sum = Rgb<double>::Zero();
    double chance = 0;
    for (int i = 0; i < kTheta; ++i) {
      const double theta_i = std::numbers::pi * ((i + 0.5) / kTheta - 0.5);
      for (int j = 0; j < kPhi; ++j) {
        const ScatteringValue<double> value =
            lobes.evaluate(direction(theta_i, 2 * std::numbers::pi * (j + 0.5) / kPhi));
        sum += value.f_cos * std::cos(theta_i);
        chance += value.pdf * std::cos(theta_i);
      }
    }
    const double cell = (std::numbers::pi / kTheta) * (2 * std::numbers::pi / kPhi);
    const Rgb<double> albedo = lobes.albedo();
    // Bins of azimuth begin anywhere between the quadrature's steps: a tenth of a bin at each of 60 jumps.
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(sum[c] * cell, albedo[c], 5e-3) << theta;
    EXPECT_NEAR(chance * cell, 1, 5e-3);
  }
}

TEST(TabulatedTest, SampledDirectionsHaveTheirDensityAndGiveTheAlbedo) {
  const TabulatedModel model(table(), {.sigma_a = {0, 0.1, 1}, .alpha = 0.4});
  const TabulatedLobes lobes = model.lobes_at(0, viewing_direction(0.62, 0));
  std::mt19937_64 engine(4);
  std::uniform_real_distribution<double> u(0, 1);
  constexpr int kSamples = 40000, kCells = 24;
  Rgb<double> sum = Rgb<double>::Zero(), squares = Rgb<double>::Zero();
  std::array<double, kCells> counted{}, expected{};
  for (int i = 0; i < kSamples; ++i) {
    const Vec3<double> wi = lobes.sample(u(engine), u(engine), u(engine), u(engine));
    const ScatteringValue<double> value = lobes.evaluate(wi);
    ASSERT_GT(value.pdf, 0);
    const Rgb<double> weight = value.f_cos / value.pdf;
    sum += weight, squares += weight * weight;
    counted[static_cast<std::size_t>((std::atan2(wi.z(), wi.y()) + std::numbers::pi) / (2 * std::numbers::pi) *
                                     kCells) %
            kCells] += 1;
  }
  for (int c = 0; c < 3; ++c) {
    const double mean = sum[c] / kSamples, error = std::sqrt((squares[c] / kSamples - mean * mean) / kSamples);
    EXPECT_NEAR(mean, lobes.albedo()[c], 5 * error + 1e-12);
  }
  constexpr int kTheta = 200, kPhi = 1200;
  for (int i = 0; i < kTheta; ++i)
    for (int j = 0; j < kPhi; ++j) {
      const double theta_i = std::numbers::pi * ((i + 0.5) / kTheta - 0.5),
                   phi = 2 * std::numbers::pi * (j + 0.5) / kPhi - std::numbers::pi;
      expected[static_cast<std::size_t>(j * kCells / kPhi)] += lobes.evaluate(direction(theta_i, phi)).pdf *
                                                               std::cos(theta_i) * std::numbers::pi / kTheta * 2 *
                                                               std::numbers::pi / kPhi * kSamples;
    }
  double chi2 = 0;
  for (std::size_t k = 0; k < kCells; ++k)
    chi2 += (counted[k] - expected[k]) * (counted[k] - expected[k]) / expected[k];
  EXPECT_LT(chi2, 60);  // 23 degrees of freedom: one in 30 000
}

TEST(TabulatedTest, IsFiniteAlongTheFiberAndRefusesTablesThatDoNotFit) {
  const TabulatedModel model(table(), {.sigma_a = {0, 0.1, 10}});
  for (double h : {-1.0, 1.0})
    for (const Vec3<double>& w : {Vec3<double>(1, 0, 0), Vec3<double>(-1, 0, 0), Vec3<double>(0, 0, 1)}) {
      const TabulatedLobes lobes = model.lobes_at(h, w);
      EXPECT_TRUE(lobes.evaluate(w).f_cos.isFinite().all());
      EXPECT_TRUE(lobes.sample(0, 0, 0, 0).allFinite());
    }
  AzimuthalTable wrong = table();
  wrong.densities.pop_back();
  EXPECT_THROW(TabulatedModel(wrong, {}), std::invalid_argument);
}

}  // namespace
}  // namespace renderer

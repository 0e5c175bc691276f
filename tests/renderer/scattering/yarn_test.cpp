#include "renderer/scattering/yarn.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "tests/renderer/scattering/scattering_statistics.h"

namespace renderer {
namespace {

double sum(const std::array<double, 3>& energies) {
  return energies[0] + energies[1] + energies[2];
}

TEST(YarnTest, FibersWithoutAbsorptionLoseLittleEnergyUnlessTheyReflectMostOfIt) {
  for (int n : {1, 2, 5, 10, 40}) {
    for (double f : {0.0, 0.05, 0.2, 0.5, 1.0}) {
      const double white = sum(yarn_lobe_energies(n, f, 1.0));
      EXPECT_LE(white, 1 + 1e-15);
      // What turns twice or more than three times is not counted. 0.046 is a fiber's F near normal incidence, where
      // up to ten fibers keep 95 %; at F = 0.5 and many fibers a fifth is missing.
      EXPECT_GE(white, f <= 0.05 && n <= 10 ? 0.95 : 0.6) << n << ' ' << f;
    }
  }
  EXPECT_DOUBLE_EQ(sum(yarn_lobe_energies(1, 0.3, 1.0)), 1);
}

// All paths that meet a row of n fibers and turn back once or three times, followed one by one.
double walk(int n, int fiber, bool forward, int turns, double a_f, double a_b) {
  if (fiber == n) return 0;                                    // left behind
  if (fiber < 0) return turns == 1 || turns == 3 ? 1.0 : 0.0;  // left in front
  const int onward = forward ? 1 : -1;
  const double through = a_f * walk(n, fiber + onward, forward, turns, a_f, a_b);
  return turns == 3 ? through : through + a_b * walk(n, fiber - onward, !forward, turns + 1, a_f, a_b);
}

TEST(YarnTest, EnergiesAreThoseOfThePathsThroughARowOfFibers) {
  const double f = 0.3, t = 0.8, through = (1 - f) * t, a_b = f / 2, a_f = a_b + through;
  for (int n : {1, 2, 3, 6}) {
    const auto energies = yarn_lobe_energies(n, f, t);
    EXPECT_DOUBLE_EQ(energies[0], f);
    EXPECT_NEAR(energies[1], through * std::pow(a_f, n - 1), 1e-15);
    EXPECT_NEAR(energies[2], through * walk(n, 1, true, 0, a_f, a_b), 1e-15) << n;
  }
}

TEST(YarnTest, EnergiesOfVeryManyFibersAreThoseOfDualScattering) {
  const double f = 0.3, t = 0.8, through = (1 - f) * t, a_b = f / 2, a_f = a_b + through, q = a_f * a_f;
  const double once = a_b * q / (1 - q), thrice = a_b * a_b * a_b * q / std::pow(1 - q, 3);
  EXPECT_NEAR(yarn_lobe_energies(1000, f, t)[2], (once + thrice) * through / a_f, 1e-12);
}

TEST(YarnTest, MoreFibersScatterLessForwardAndMoreBack) {
  double forward = 2, back = -1;
  for (int count : {5, 10, 20, 40, 80}) {
    const YarnModel<double> model({.fiber_count = count, .radius_ratio = 0.2});
    const auto lobes = model.lobes_at(0.1, viewing_direction(0.3, 0.1));
    EXPECT_LT(lobes.attenuation(1, 0), forward) << count;
    EXPECT_GT(lobes.attenuation(2, 0), back) << count;
    forward = lobes.attenuation(1, 0), back = lobes.attenuation(2, 0);
  }
}

TEST(YarnTest, VariancesAddOverTheFibersOnTheChord) {
  const YarnParameters parameters{.fiber_count = 60, .radius_ratio = 0.1};
  const YarnModel<double> model(parameters);
  const double v_r = longitudinal_variance(parameters.beta_r), v_tt = longitudinal_variance(parameters.beta_tt);
  const double s_tt = azimuthal_scale(parameters.gamma_tt);
  for (double h : {0.0, 0.5, 0.9, 0.995, -1.0}) {
    const int n = std::max(1, static_cast<int>(std::lround(4 / std::numbers::pi * 6 * std::sqrt(1 - h * h))));
    const LobeWidths<double>& widths = *model.lobes_at(h, viewing_direction(0.2, h)).widths;
    EXPECT_DOUBLE_EQ(widths.v[0], v_r);
    EXPECT_DOUBLE_EQ(widths.v[1], n * v_tt) << h;
    EXPECT_NEAR(widths.s[1] * widths.s[1], n * s_tt * s_tt, 1e-15) << h;
    EXPECT_DOUBLE_EQ(widths.v[2], n * v_tt + v_r) << h;
  }
}

TEST(YarnTest, AbsorptionActsOnTransmittedLightOnly) {
  const YarnModel<double> clear({}), dyed({.sigma_a = {0.3, 1, 3}});
  const auto a = clear.lobes_at(0.2, viewing_direction(0.3, 0.2)), b = dyed.lobes_at(0.2, viewing_direction(0.3, 0.2));
  for (int c = 0; c < 3; ++c) {
    EXPECT_DOUBLE_EQ(a.attenuation(0, c), b.attenuation(0, c));
    for (int p : {1, 2}) EXPECT_GT(a.attenuation(p, c), b.attenuation(p, c));
  }
}

TEST(YarnTest, TransmittanceIsThatOfTheMeanChord) {
  const double theta = 0.7, eta = 1.55, ratio = 0.15, sigma = 2;
  const YarnModel<double> model({.fiber_count = 1, .radius_ratio = ratio, .eta = eta, .sigma_a = {0, sigma, 0}});
  const auto lobes = model.lobes_at(0.0, viewing_direction(theta, 0));
  double chord = 0;
  constexpr int kSteps = 1000;
  for (int k = 0; k < kSteps; ++k)
    chord += InnerChord<double>((k + 0.5) / kSteps, std::sin(theta), std::cos(theta), eta).length / kSteps;
  const double found = std::log(lobes.attenuation(1, 0) / lobes.attenuation(1, 1)) / (sigma * ratio);
  EXPECT_NEAR(found / chord, 1, 0.007);
}

TEST(YarnTest, MirroringTheCrossSectionMirrorsTheScattering) {
  const YarnModel<double> model({.sigma_a = {0.1, 0.3, 0.8}});
  const auto value = model.lobes_at(0.4, viewing_direction(0.2, 0.4)).evaluate(direction(-0.3, 1.1));
  const auto mirrored =
      model.lobes_at(-0.4, viewing_direction(0.2, -0.4)).evaluate(direction(-0.3, std::numbers::pi - 1.1));
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(value.f_cos[c], mirrored.f_cos[c], 1e-14);
}

}  // namespace
}  // namespace renderer

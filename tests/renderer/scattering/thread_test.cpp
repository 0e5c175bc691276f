#include "renderer/scattering/thread.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "tests/renderer/scattering/scattering_statistics.h"

namespace renderer {
namespace {

using Values = std::array<double, kThreadParameterCount>;

// sigma_a, alpha, beta, r0, r1, r2
const Values kValues{0.1, 0.3, 0.8, 0.3, 0.2, 0.4, 0.5, 0.6, 0.1, -0.44, 0.16, 0.58, 0.66, 15.6, 2.0, -0.03};

double sum_of_energies(const ThreadParameters& parameters, double theta) {
  const auto lambda = thread_lobe_energies(parameters, std::cos(theta));
  return lambda[0] + lambda[1] + lambda[2];
}

TEST(ThreadTest, EnergiesFollowTheEquationsOfThePaper) {
  ThreadParameters p = thread_parameters(kValues, false);
  const auto lambda = thread_lobe_energies(p, 0.5);
  EXPECT_NEAR(lambda[0], -0.44 * 0.25 + 0.16 * 0.5 + 0.58, 1e-15);
  EXPECT_NEAR(lambda[1], 0.33, 1e-15);
  EXPECT_NEAR(lambda[2], 1 / (7.8 + 2.0) - 0.03, 1e-15);
}

TEST(ThreadTest, LimitedEnergyNeverReachesOneAndIsUntouchedBelow) {
  Values values = kValues;
  values[14] = 0.01;  // lambda_2 explodes at grazing angles
  const ThreadParameters limited = thread_parameters(values, true), free = thread_parameters(values, false);
  EXPECT_GT(sum_of_energies(free, 1.55), 2);
  for (double theta : {0.0, 0.5, 1.0, 1.5, 1.57})
    EXPECT_NEAR(sum_of_energies(limited, theta), std::min(kMostEnergy, sum_of_energies(free, theta)), 1e-14);
}

TEST(ThreadTest, AbsorptionActsOnTransmittedLobesOnceAndOnReflectionNot) {
  Values clear = kValues;
  clear[0] = clear[1] = clear[2] = 0;
  const double theta = 0.4, h = 0.3;
  const ThreadModel<double> dyed_model(thread_parameters(kValues, false)), clear_model(thread_parameters(clear, false));
  const auto dyed = dyed_model.lobes_at(h, viewing_direction(theta, h));
  const auto white = clear_model.lobes_at(h, viewing_direction(theta, h));
  const double sin_theta_t = std::sin(theta) / kThreadEta;
  const double sin_gamma_t =
      h * std::cos(theta) / std::sqrt(kThreadEta * kThreadEta - std::sin(theta) * std::sin(theta));
  const double chord = 2 * std::sqrt(1 - sin_gamma_t * sin_gamma_t) / std::sqrt(1 - sin_theta_t * sin_theta_t);
  for (int c = 0; c < 3; ++c) {
    const double transmittance = std::exp(-kValues[static_cast<std::size_t>(c)] * chord);
    EXPECT_NEAR(dyed.attenuation(0, c), white.attenuation(0, c), 1e-15);
    EXPECT_NEAR(dyed.attenuation(1, c), white.attenuation(1, c) * transmittance, 1e-14);
    EXPECT_NEAR(dyed.attenuation(2, c), white.attenuation(2, c) * transmittance, 1e-14);
  }
}

TEST(ThreadTest, TheTintColoursTheReflectionAlone) {
  ThreadParameters tinted = thread_parameters(kValues, true);
  tinted.lambda0_rgb = {1, 0.7, 0.2};
  const ThreadModel<double> white(thread_parameters(kValues, true)), gold(tinted);
  const auto a = white.lobes_at(0.3, viewing_direction(0.4, 0.3)), b = gold.lobes_at(0.3, viewing_direction(0.4, 0.3));
  for (int c = 0; c < 3; ++c) {
    EXPECT_DOUBLE_EQ(b.attenuation(0, c), a.attenuation(0, c) * tinted.lambda0_rgb[c]);
    for (int p : {1, 2}) EXPECT_EQ(b.attenuation(p, c), a.attenuation(p, c));
  }
}

TEST(ThreadTest, TransmittancePowersLengthenTheWayOfEachInnerLobe) {
  ThreadParameters longer = thread_parameters(kValues, false);
  longer.transmittance_powers = {1.5, 2};
  Values clear = kValues;
  clear[0] = clear[1] = clear[2] = 0;
  const auto at = [](const ThreadModel<double>& model) { return model.lobes_at(0.3, viewing_direction(0.4, 0.3)); };
  const ThreadModel<double> white_model(thread_parameters(clear, false)), dyed_model(thread_parameters(kValues, false)),
      longer_model(longer);
  const auto white = at(white_model), dyed = at(dyed_model), found = at(longer_model);
  for (int c = 0; c < 3; ++c) {
    const double t = dyed.attenuation(1, c) / white.attenuation(1, c);
    EXPECT_EQ(found.attenuation(0, c), dyed.attenuation(0, c));
    EXPECT_NEAR(found.attenuation(1, c), white.attenuation(1, c) * std::pow(t, 1.5), 1e-14);
    EXPECT_NEAR(found.attenuation(2, c), white.attenuation(2, c) * t * t, 1e-14);
  }
}

TEST(ThreadTest, EveryLobeIsSampledEvenWithoutEnergy) {
  Values values = kValues;
  values[9] = values[10] = values[11] = 0;
  const ThreadModel<double> model(thread_parameters(values, true));
  const auto lobes = model.lobes_at(0.4, viewing_direction(0.2, 0.4));
  EXPECT_NEAR(lobes.probability.sum(), 1, 1e-14);
  EXPECT_NEAR(lobes.probability[0], kLobeFloor, 1e-14);
  EXPECT_EQ(lobes.probability[3], 0);
}

}  // namespace
}  // namespace renderer

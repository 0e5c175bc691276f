#include "renderer/scattering/thread.h"

#include <ceres/jet.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>

#include "renderer/scattering/thread_gradient.h"
#include "scattering_statistics.h"

namespace renderer {
namespace {

using Values = std::array<double, kThreadParameterCount>;
using Jet = ceres::Jet<double, kThreadParameterCount>;

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

TEST(ThreadTest, FurnaceWithoutAbsorptionIsTheSumOfTheLobeEnergies) {
  Values values = kValues;
  values[0] = values[1] = values[2] = 0;
  for (bool limited : {false, true}) {
    const ThreadParameters parameters = thread_parameters(values, limited);
    const ThreadModel<double> model(parameters);
    for (double theta : {-1.48, -0.6, 0.0, 1.1, 1.4}) {
      for (double h : {-0.97, 0.2, 0.8}) {
        const auto lobes = model.lobes_at(h, viewing_direction(theta, h));
        EXPECT_NEAR(energy(lobes, 1), sum_of_energies(parameters, theta), 1e-3) << theta << ' ' << h;
      }
    }
  }
}

TEST(ThreadTest, LimitedEnergyNeverReachesOneAndIsUntouchedBelow) {
  Values values = kValues;
  values[14] = 0.01;  // lambda_2 explodes at grazing angles
  const ThreadParameters limited = thread_parameters(values, true), free = thread_parameters(values, false);
  EXPECT_GT(sum_of_energies(free, 1.55), 2);
  for (double theta : {0.0, 0.5, 1.0, 1.5, 1.57}) {
    EXPECT_NEAR(sum_of_energies(limited, theta), std::min(kMostEnergy, sum_of_energies(free, theta)), 1e-14);
  }
}

TEST(ThreadTest, AbsorptionActsOnTransmittedLobesOnceAndOnReflectionNot) {
  Values clear = kValues;
  clear[0] = clear[1] = clear[2] = 0;
  const double theta = 0.4, h = 0.3;
  const ThreadModel<double> dyed_model(thread_parameters(kValues, false)),
      clear_model(thread_parameters(clear, false));
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

TEST(ThreadTest, SampledDirectionsFollowTheDensity) {
  constexpr int kTests = 12;
  std::uint64_t seed = 1;
  for (double beta_trt : {0.1, 0.5}) {
    Values values = kValues;
    values[8] = beta_trt;
    const ThreadModel<double> model(thread_parameters(values, true));
    for (double theta : {-0.3, 1.2}) {
      for (double h : {-0.9, 0.1, 0.6}) {
        const double p = sampling_p_value(model.lobes_at(h, viewing_direction(theta, h)), 40000, seed++);
        EXPECT_GT(p, 0.01 / kTests) << theta << ' ' << h;  // Bonferroni: 1 % for all of them together
      }
    }
  }
}

TEST(ThreadTest, SampledAlbedoIsTheSumOfTheAttenuations) {
  const ThreadModel<double> model(thread_parameters(kValues, true));
  for (double theta : {0.0, 1.2}) {
    const auto lobes = model.lobes_at(0.4, viewing_direction(theta, 0.4));
    const SampledMean albedo = sampled_albedo(lobes, 40000, 7);
    for (int c = 0; c < 3; ++c) {  // five standard errors: one false alarm in a million
      EXPECT_NEAR(albedo.mean[c], lobes.attenuation.col(c).sum(), 5 * albedo.standard_error[c]);
    }
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

struct Angles {
  double theta_o, h, theta_i, phi_i;
};

template <class S>
Rgb<S> value_at(const std::array<S, kThreadParameterCount>& p, bool limited, const Angles& g) {
  const ThreadModel<S> model(thread_parameters(p, limited));
  return model.lobes_at(g.h, viewing_direction(g.theta_o, g.h)).evaluate(direction(g.theta_i, g.phi_i)).f_cos;
}

std::array<Jet, kThreadParameterCount> jets(const Values& values) {
  std::array<Jet, kThreadParameterCount> out;
  for (int k = 0; k < kThreadParameterCount; ++k)
    out[static_cast<std::size_t>(k)] = Jet(values[static_cast<std::size_t>(k)], k);
  return out;
}

TEST(ThreadTest, DerivativesOfAllParametersAgreeWithFiniteDifferences) {
  Values bright = kValues;
  bright[12] = 0.9;  // the limit is active
  for (bool limited : {false, true}) {
    const Values& values = limited ? bright : kValues;
    for (const Angles& g : {Angles{0.2, 0.3, -0.4, 1.0}, Angles{-0.9, -0.8, 0.7, -2.0}, Angles{0, 0.05, 0.1, -1.4}}) {
      const Rgb<Jet> dual = value_at(jets(values), limited, g);
      const Rgb<double> plain = value_at(values, limited, g);
      for (int k = 0; k < kThreadParameterCount; ++k) {
        constexpr double kStep = 1e-5;  // balances the step's cube and rounding
        Values above = values, below = values;
        above[static_cast<std::size_t>(k)] += kStep, below[static_cast<std::size_t>(k)] -= kStep;
        const Rgb<double> expected = (value_at(above, limited, g) - value_at(below, limited, g)) / (2 * kStep);
        for (int c = 0; c < 3; ++c) {
          EXPECT_NEAR(dual[c].v[k], expected[c], 1e-5 * (std::abs(expected[c]) + plain[c])) << k << ' ' << c;
        }
      }
    }
  }
}

TEST(ThreadTest, ValuesAndDerivativesAreFiniteAtGrazingOffsetsInclinationsAndExtremeParameters) {
  for (double roughness : {0.02, 1.0}) {
    for (double sigma : {0.0, 1000.0}) {
      Values values = kValues;
      for (std::size_t k = 0; k < 3; ++k) values[k] = sigma, values[3 + k] = values[6 + k] = roughness;
      values[14] = 1e-2;
      for (double h : {-1.0, 0.0, 1.0}) {
        for (double theta : {-kPi / 2, 0.0, 1.5707, kPi / 2}) {
          for (double phi : {-kPi, 0.0, 1.0}) {
            const Rgb<Jet> value = value_at(jets(values), true, {theta, h, -theta, phi});
            for (int c = 0; c < 3; ++c) EXPECT_TRUE(std::isfinite(value[c].a) && value[c].v.allFinite());
          }
        }
      }
    }
  }
}

// All derivatives of one channel in the order of Values; the two other channels' absorptions give none.
std::array<double, kThreadParameterCount> slopes_of(const ThreadGradient<double>& gradient, int channel) {
  std::array<double, kThreadParameterCount> slopes{};
  slopes[static_cast<std::size_t>(channel)] = gradient.slopes(kSlopeSigma, channel);
  for (int k = 1; k < kThreadSlopeCount; ++k) slopes[static_cast<std::size_t>(k + 2)] = gradient.slopes(k, channel);
  return slopes;
}

template <class S>
ThreadPoint<S> point_of(double theta, double h) {
  const InnerChord<double> chord(h, std::sin(theta), std::cos(theta), kThreadEta);
  return {static_cast<S>(std::cos(theta)), static_cast<S>(chord.length)};
}

TEST(ThreadTest, ClosedFormDerivativesAreThoseOfDualNumbers) {
  std::array<Jet, kThreadParameterCount> jets;
  for (std::size_t k = 0; k < jets.size(); ++k) jets[k] = Jet(kValues[k], static_cast<int>(k));
  const ThreadModel<Jet> dual_model(thread_parameters(jets, false));
  const ThreadGradientModel<double> model(thread_parameters(kValues, false));
  for (double theta_o : {-1.45, -0.5, 0.0, 0.9})
    for (double h : {-0.9, 0.1, 0.6})
      for (double theta_i : {-0.8, 0.02, 0.6, 1.4})
        for (double phi : {-3.0, -1.5, 0.2, 1.9}) {
          const Vec3<double> wo = viewing_direction(theta_o, h), wi = direction(theta_i, phi);
          const auto lobes = ThreadModel<double>(thread_parameters(kValues, false)).lobes_at(h, wo);
          const auto expected = dual_model.lobes_at(h, wo).evaluate(wi);
          const auto found = model.evaluate(point_of<double>(theta_o, h), lobes.angles(wi));
          for (int channel = 0; channel < 3; ++channel) {
            const Jet& jet = expected.f_cos[channel];
            EXPECT_NEAR(found.f_cos[channel], jet.a, 1e-12 * (1 + jet.a));
            for (std::size_t k = 0; k < jets.size(); ++k) {
              const double slope = jet.v[static_cast<int>(k)];
              EXPECT_NEAR(slopes_of(found, channel)[k], slope, 1e-10 * (jet.a + std::abs(slope)) + 1e-14)
                  << "parameter " << k << " at " << theta_o << ' ' << h << ' ' << theta_i << ' ' << phi;
            }
          }
        }
}

TEST(ThreadTest, ClosedFormDerivativesInFloatLoseNoMoreThanFloats) {
  Values values = kValues;
  values[8] = 0.03;  // the narrowest lobe there is: the largest derivatives
  values[5] = 0.03;
  const ThreadGradientModel<double> exact(thread_parameters(values, false));
  std::array<float, kThreadParameterCount> single{};
  for (std::size_t k = 0; k < single.size(); ++k) single[k] = static_cast<float>(values[k]);
  const ThreadGradientModel<float> rounded(thread_parameters(single, false));
  for (double h : {-0.9, 0.1, 0.6})
    for (double theta_i : {-0.5, 0.45, 0.52}) {
      const Vec3<double> wo = viewing_direction(-0.5, h);
      const auto at =
          ThreadModel<double>(thread_parameters(values, false)).lobes_at(h, wo).angles(direction(theta_i, 0.3));
      const LobeAngles<float> at_float{at.distance2.cast<float>(), at.cos_cos.cast<float>(),
                                       at.from_center.cast<float>()};
      const auto expected = exact.evaluate(point_of<double>(-0.5, h), at);
      const auto found = rounded.evaluate(point_of<float>(-0.5, h), at_float);
      for (int k = 0; k < kThreadSlopeCount; ++k) {
        const double slope = expected.slopes(k, 1);
        // exp of arguments up to 100 in float: 1e-5; beside terms of the size f / roughness that cancel
        EXPECT_NEAR(static_cast<double>(found.slopes(k, 1)), slope, 3e-4 * (std::abs(slope) + expected.f_cos[1]));
      }
    }
}

}  // namespace
}  // namespace renderer

#include "renderer/scattering/yarn.h"

#include <ceres/jet.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "scattering_statistics.h"

namespace renderer {
namespace {

const std::vector<YarnParameters> kYarns{
    {},
    {.fiber_count = 1,
     .radius_ratio = 1,
     .sigma_a = {0.1, 0.3, 0.8},
     .beta_r = 0.1,
     .beta_tt = 0.15,
     .gamma_tt = 0.2},
    {.fiber_count = 80, .radius_ratio = 0.08, .sigma_a = {2, 1, 0.1}, .beta_r = 0.6, .beta_tt = 0.3, .gamma_tt = 0.1},
    {.fiber_count = 10, .radius_ratio = 0.25, .eta = 1.3, .beta_r = 1, .beta_tt = 1, .gamma_tt = 1},
};

double sum(const std::array<double, 3>& energies) {
  return energies[0] + energies[1] + energies[2];
}

TEST(YarnTest, EnergyNeverExceedsOneAndIsThatOfTheFurnace) {
  for (const YarnParameters& parameters : kYarns) {
    const YarnModel<double> model(parameters);
    for (double theta : {-1.48, -0.6, 0.0, 1.1, 1.4}) {
      for (double h : {-0.97, 0.2, 0.8}) {
        const auto lobes = model.lobes_at(h, viewing_direction(theta, h));
        for (int c : {0, 2}) {
          const double found = energy(lobes, c);
          EXPECT_NEAR(found, lobes.attenuation.col(c).sum(), 1e-3) << theta << ' ' << h;
          EXPECT_LE(found, 1 + 1e-3);
        }
      }
    }
  }
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
    const int n = std::max(1, static_cast<int>(std::lround(4 / kPi * 6 * std::sqrt(1 - h * h))));
    const LobeWidths<double>& widths = *model.lobes_at(h, viewing_direction(0.2, h)).widths;
    EXPECT_DOUBLE_EQ(widths.v[0], v_r);
    EXPECT_DOUBLE_EQ(widths.v[1], n * v_tt) << h;
    EXPECT_NEAR(widths.s[1] * widths.s[1], n * s_tt * s_tt, 1e-15) << h;
    EXPECT_DOUBLE_EQ(widths.v[2], n * v_tt + v_r) << h;
  }
}

TEST(YarnTest, AbsorptionActsOnTransmittedLightOnly) {
  const YarnModel<double> clear({}), dyed({.sigma_a = {0.3, 1, 3}});
  const auto a = clear.lobes_at(0.2, viewing_direction(0.3, 0.2)),
             b = dyed.lobes_at(0.2, viewing_direction(0.3, 0.2));
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
  const auto mirrored = model.lobes_at(-0.4, viewing_direction(0.2, -0.4)).evaluate(direction(-0.3, kPi - 1.1));
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(value.f_cos[c], mirrored.f_cos[c], 1e-14);
}

TEST(YarnTest, SampledDirectionsFollowTheDensity) {
  constexpr int kTests = 24;
  std::uint64_t seed = 1;
  for (const YarnParameters& parameters : kYarns) {
    const YarnModel<double> model(parameters);
    for (double theta : {-0.3, 1.2}) {
      for (double h : {-0.9, 0.1, 0.6}) {
        const double p = sampling_p_value(model.lobes_at(h, viewing_direction(theta, h)), 40000, seed++);
        EXPECT_GT(p, 0.01 / kTests) << theta << ' ' << h;  // Bonferroni: 1 % for all of them together
      }
    }
  }
}

TEST(YarnTest, SampledAlbedoIsTheSumOfTheAttenuations) {
  for (const YarnParameters& parameters : kYarns) {
    const YarnModel<double> model(parameters);
    const auto lobes = model.lobes_at(0.4, viewing_direction(1.2, 0.4));
    const SampledMean albedo = sampled_albedo(lobes, 20000, 7);
    for (int c = 0; c < 3; ++c) {  // five standard errors: one false alarm in a million; 1e-9 where there is no error
      EXPECT_NEAR(albedo.mean[c], lobes.attenuation.col(c).sum(), 5 * albedo.standard_error[c] + 1e-9);
    }
  }
}

constexpr int kValueCount = 7;
using Values = std::array<double, kValueCount>;  // eta, sigma_a, beta_r, beta_tt, gamma_tt
using Jet = ceres::Jet<double, kValueCount>;

template <class S>
ScatteringValue<S> value_at(const std::array<S, kValueCount>& p, double theta_o, double h, const Vec3<double>& wi) {
  const YarnModel<S> model(BasicYarnParameters<S>{.fiber_count = 30,
                                                  .radius_ratio = 0.12,
                                                  .eta = p[0],
                                                  .sigma_a = {p[1], p[2], p[3]},
                                                  .beta_r = p[4],
                                                  .beta_tt = p[5],
                                                  .gamma_tt = p[6]});
  return model.lobes_at(h, viewing_direction(theta_o, h)).evaluate(wi);
}

TEST(YarnTest, DerivativesAgreeWithFiniteDifferences) {
  const Values values{1.55, 0.3, 0.9, 2.4, 0.2, 0.25, 0.3};
  std::array<Jet, kValueCount> jets;
  for (std::size_t k = 0; k < jets.size(); ++k) jets[k] = Jet(values[k], static_cast<int>(k));
  for (double h : {-0.95, 0.1, 0.7}) {
    for (double theta_o : {-0.9, 0.2}) {
      const Vec3<double> wi = direction(0.3, -1.2);
      const auto dual = value_at(jets, theta_o, h, wi);
      for (std::size_t k = 0; k < jets.size(); ++k) {
        constexpr double kStep = 1e-5;  // balances the step's cube and rounding
        Values above = values, below = values;
        above[k] += kStep, below[k] -= kStep;
        const auto high = value_at(above, theta_o, h, wi), low = value_at(below, theta_o, h, wi);
        for (int c = 0; c < 3; ++c) {
          const double expected = (high.f_cos[c] - low.f_cos[c]) / (2 * kStep);
          EXPECT_NEAR(dual.f_cos[c].v[static_cast<int>(k)], expected, 1e-6 * (std::abs(expected) + dual.f_cos[c].a));
        }
        EXPECT_NEAR(dual.pdf.v[static_cast<int>(k)], (high.pdf - low.pdf) / (2 * kStep), 1e-6 * (1 + dual.pdf.a));
      }
    }
  }
}

template <class S>
void expect_finite_everywhere() {
  for (S h : {S(-1), S(0), S(1)}) {
    for (S theta : {S(-kPi / 2), S(-1.5707), S(0), S(1.57), S(kPi / 2)}) {
      for (S roughness : {S(0.02), S(1)}) {
        for (S sigma : {S(0), S(1e6)}) {
          const YarnModel<S> model(BasicYarnParameters<S>{.fiber_count = 100,
                                                          .radius_ratio = 0.1,
                                                          .sigma_a = Vec3<S>::Constant(sigma),
                                                          .beta_r = roughness,
                                                          .beta_tt = roughness,
                                                          .gamma_tt = roughness});
          const Vec3<S> wo = viewing_direction(static_cast<double>(theta), static_cast<double>(h)).template cast<S>();
          const auto lobes = model.lobes_at(h, wo);
          EXPECT_NEAR(static_cast<double>(lobes.probability.sum()), 1, 1e-5);
          for (const Vec3<S>& wi : {Vec3<S>(1, 0, 0), Vec3<S>(-1, 0, 0), Vec3<S>(0, 0, 1), Vec3<S>(-wo)}) {
            const auto value = lobes.evaluate(wi);
            EXPECT_TRUE(value.f_cos.isFinite().all() && (value.f_cos >= 0).all());
            EXPECT_TRUE(std::isfinite(value.pdf) && value.pdf >= 0);
          }
          const S last = std::nextafter(S(1), S(0));
          for (S u : {S(0), last}) EXPECT_TRUE(lobes.sample(u, u, u, u).allFinite());
        }
      }
    }
  }
}

TEST(YarnTest, IsFiniteAtGrazingOffsetsInclinationsAndExtremeParameters) {
  expect_finite_everywhere<double>();
  expect_finite_everywhere<float>();
}

}  // namespace
}  // namespace renderer

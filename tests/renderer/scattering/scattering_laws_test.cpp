// Laws that every scattering model of a curve obeys, over a grid of roughnesses, inclinations and offsets.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "renderer/scattering/degree.h"
#include "renderer/scattering/fiber.h"
#include "renderer/scattering/thread.h"
#include "renderer/scattering/yarn.h"
#include "tests/renderer/scattering/scattering_statistics.h"

namespace renderer {
namespace {

constexpr double kRoughnesses[] = {0.02, 0.1, 0.3, 0.6, 1.0};
constexpr double kInclinationsDeg[] = {-85, -50, -10, 30, 85};
constexpr double kOffsets[] = {-0.99, -0.5, 0.05, 0.8};

struct Model {
  std::string name;
  std::function<CurveLobes<double>(double h, const Vec3<double>& wo)> lobes_at;
};

template <template <class> class Prepared, class Parameters>
Model model(const std::string& name, const Parameters& parameters) {
  const auto prepared = std::make_shared<Prepared<double>>(parameters);
  return {name, [prepared](double h, const Vec3<double>& wo) { return prepared->lobes_at(h, wo); }};
}

std::string text(double a, double b) {
  return std::to_string(a) + ' ' + std::to_string(b);
}

// The first channel absorbs nothing.
std::vector<Model> fibers() {
  std::vector<Model> models;
  for (double beta_m : kRoughnesses)
    for (double beta_n : kRoughnesses)
      models.push_back(model<FiberModel>(
          "fiber " + text(beta_m, beta_n),
          FiberParameters{.sigma_a = {0, 0.3, 2}, .beta_m = beta_m, .beta_n = beta_n, .tilt_rad = 0.03 * beta_m}));
  return models;
}

// Energies near those of simulated bundles of fibers; without limit they exceed 1 towards grazing inclinations.
ThreadParameters thread(double alpha, double beta) {
  return {.sigma_a = {0, 0.3, 2},
          .alpha = {alpha, 1.02 - alpha, alpha},
          .beta = {beta, beta, 1.02 - beta},
          .r0a = -0.44,
          .r0b = 0.16,
          .r0c = 0.58,
          .r1a = 0.66,
          .r2a = 15.6,
          .r2b = 0.5,
          .r2c = -0.03};
}

std::vector<Model> threads() {
  std::vector<Model> models;
  for (double alpha : kRoughnesses)
    for (double beta : kRoughnesses)
      models.push_back(model<ThreadModel>("thread " + text(alpha, beta), thread(alpha, beta)));
  return models;
}

std::vector<Model> yarns() {
  std::vector<Model> models;
  for (int count : {1, 20, 80})
    for (double roughness : kRoughnesses)
      models.push_back(model<YarnModel>("yarn " + text(count, roughness), YarnParameters{.fiber_count = count,
                                                                                         .radius_ratio = 0.1,
                                                                                         .sigma_a = {0, 0.3, 2},
                                                                                         .beta_r = roughness,
                                                                                         .beta_tt = roughness,
                                                                                         .gamma_tt = roughness}));
  return models;
}

std::vector<Model> all_models() {
  std::vector<Model> models = fibers();
  for (const auto& more : {threads(), yarns()}) models.insert(models.end(), more.begin(), more.end());
  return models;
}

// Calls judge(lobes, theta, h, name of the place) at every place of the grid.
template <class Judge>
void everywhere(const std::vector<Model>& models, const Judge& judge) {
  for (const Model& m : models)
    for (double theta_deg : kInclinationsDeg)
      for (double h : kOffsets) {
        const double theta = theta_deg * kDegree;
        judge(m.lobes_at(h, viewing_direction(theta, h)), theta, h,
              m.name + " at " + text(theta_deg, h) + " (deg, radii)");
      }
}

constexpr double kQuadrature = 1e-3;  // steps of half the narrowest width

TEST(ScatteringLawsTest, TheWholeFunctionIntegratesToTheAttenuations) {
  everywhere(all_models(), [](const auto& lobes, double, double, const std::string& place) {
    const Rgb<double> found = energy(lobes);
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(found[c], lobes.attenuation.col(c).sum(), kQuadrature) << place << c;
  });
}

TEST(ScatteringLawsTest, TheWhiteFurnaceOfFibersIsOne) {
  everywhere(fibers(), [](const auto& lobes, double, double, const std::string& place) {
    EXPECT_NEAR(energy(lobes)[0], 1, kQuadrature) << place;
  });
}

TEST(ScatteringLawsTest, TheWhiteFurnaceOfThreadsIsTheSumOfTheirEnergiesAndBelowOne) {
  everywhere(threads(), [](const auto& lobes, double theta, double, const std::string& place) {
    ThreadParameters unlimited = thread(0.3, 0.3);
    unlimited.limit_energy = false;
    const auto lambda = thread_lobe_energies(unlimited, std::cos(theta));
    EXPECT_NEAR(energy(lobes)[0], std::min(kMostEnergy, lambda[0] + lambda[1] + lambda[2]), kQuadrature) << place;
  });
}

TEST(ScatteringLawsTest, NothingScattersMoreLightThanItReceives) {
  everywhere(all_models(), [](const auto& lobes, double, double, const std::string& place) {
    for (int c = 0; c < 3; ++c) EXPECT_LE(lobes.attenuation.col(c).sum(), 1 + 1e-12) << place << c;
  });
}

TEST(ScatteringLawsTest, SampledDirectionsFollowTheDensity) {
  const auto models = all_models();
  const double tests = static_cast<double>(models.size() * std::size(kInclinationsDeg) * std::size(kOffsets));
  std::uint64_t seed = 1;
  everywhere(models, [&](const auto& lobes, double, double, const std::string& place) {
    EXPECT_GT(sampling_p_value(lobes, 6000, seed++), 0.01 / tests) << place;  // Bonferroni: 1 % for all together
  });
}

TEST(ScatteringLawsTest, DensitiesAreTheInverseJacobiansOfTheSamplingMaps) {
  everywhere(all_models(), [](const auto& lobes, double, double h, const std::string& place) {
    for (int p = 0; p < 4; ++p) {
      if (lobes.probability[p] == 0) continue;
      EXPECT_LT(azimuth_map_error(lobes, p), 1e-6) << place << p;      // differences of steps of 1e-6
      if (h != kOffsets[0]) continue;                                  // inclination does not depend on the offset
      EXPECT_LT(inclination_map_error(lobes, p), 1e-3) << place << p;  // quadrature with kinks, 500 steps
    }
  });
}

TEST(ScatteringLawsTest, SampledWeightsAverageToTheAttenuations) {
  std::uint64_t seed = 1;
  everywhere(all_models(), [&](const auto& lobes, double, double, const std::string& place) {
    const SampledMean albedo = sampled_albedo(lobes, 2000, seed++);
    for (int c = 0; c < 3; ++c)  // five standard errors: one false alarm in a million; 1e-9 where there is no error
      EXPECT_NEAR(albedo.mean[c], lobes.attenuation.col(c).sum(), 5 * albedo.standard_error[c] + 1e-9) << place << c;
  });
}

TEST(ScatteringLawsTest, LobesChosenByTheirEnergyGiveEverySampleTheSameMeanWeight) {
  auto models = fibers();
  for (const Model& m : yarns()) models.push_back(m);
  everywhere(models, [](const auto& lobes, double, double, const std::string& place) {
    const SampledMean albedo = sampled_albedo(lobes, 200, 3);
    EXPECT_NEAR(albedo.least_weight, albedo.greatest_weight, 1e-9) << place;
  });
}

TEST(ScatteringLawsTest, TheFloorOfThreadsRaisesNoWeightByMoreThanItsShare) {
  everywhere(threads(), [](const auto& lobes, double, double, const std::string& place) {
    const double albedo = lobes.attenuation.sum() / 3;
    EXPECT_LE(sampled_albedo(lobes, 200, 3).greatest_weight, albedo / (1 - 3 * kLobeFloor) + 1e-9) << place;
  });
}

template <template <class> class Prepared, class S, class Parameters>
bool finite(const Parameters& parameters) {
  const Prepared<S> prepared(in_scalar<S>(parameters));
  return finite_everywhere<S>([&](S h, const Vec3<S>& wo) { return prepared.lobes_at(h, wo); });
}

template <class S>
void expect_finite() {
  for (double roughness : {0.02, 1.0}) {
    for (double sigma : {0.0, 1000.0}) {
      const Vec3<double> sigma_a = Vec3<double>::Constant(sigma);
      EXPECT_TRUE((finite<FiberModel, S>(
          FiberParameters{.sigma_a = sigma_a, .beta_m = roughness, .beta_n = roughness, .tilt_rad = 0.05})));
      ThreadParameters thread_parameters = thread(roughness, roughness);
      thread_parameters.sigma_a = sigma_a;
      thread_parameters.r2b = 1e-2;
      EXPECT_TRUE((finite<ThreadModel, S>(thread_parameters)));
      EXPECT_TRUE((finite<YarnModel, S>(YarnParameters{.fiber_count = 100,
                                                       .radius_ratio = 0.1,
                                                       .sigma_a = sigma_a,
                                                       .beta_r = roughness,
                                                       .beta_tt = roughness,
                                                       .gamma_tt = roughness})));
    }
  }
}

TEST(ScatteringLawsTest, EverythingIsFiniteAtGrazingOffsetsInclinationsAndExtremeParameters) {
  expect_finite<double>();
  expect_finite<float>();
}

}  // namespace
}  // namespace renderer

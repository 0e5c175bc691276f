#include <gtest/gtest.h>

#include <vector>

#include "renderer/scattering/fiber.h"
#include "scattering_statistics.h"

namespace renderer {
namespace {

const std::vector<FiberParameters> kFibers{
    {},
    {.sigma_a = {0.1, 0.3, 0.8}, .beta_m = 0.15, .beta_n = 0.2},
    {.eta = 1.4, .sigma_a = {2, 1, 0.1}, .beta_m = 0.6, .beta_n = 0.4, .tilt_rad = 0.05},
    {.beta_m = 1.0, .beta_n = 1.0},
};

TEST(FiberSamplingTest, SampledDirectionsFollowTheDensity) {
  constexpr int kTests = 36;
  std::uint64_t seed = 1;
  for (const FiberParameters& parameters : kFibers) {
    const FiberModel<double> model(parameters);
    for (double theta : {-0.2, 0.7, 1.4}) {
      for (double h : {-0.95, 0.05, 0.7}) {
        const double p = sampling_p_value(model.lobes_at(h, viewing_direction(theta, h)), 40000, seed++);
        EXPECT_GT(p, 0.01 / kTests) << theta << ' ' << h;  // Bonferroni: 1 % for all of them together
      }
    }
  }
}

TEST(FiberSamplingTest, SampledFurnaceIsTheSumOfTheAttenuations) {
  std::uint64_t seed = 100;
  for (const FiberParameters& parameters : kFibers) {
    const FiberModel<double> model(parameters);
    for (double theta : {0.0, 1.2}) {
      const auto lobes = model.lobes_at(0.4, viewing_direction(theta, 0.4));
      const SampledMean albedo = sampled_albedo(lobes, 20000, seed++);
      for (int c = 0; c < 3; ++c) {
        // Five standard errors: one false alarm in a million; the density is exact, so white fibers have no error.
        EXPECT_NEAR(albedo.mean[c], lobes.attenuation.col(c).sum(), 5 * albedo.standard_error[c] + 1e-9);
      }
    }
  }
}

}  // namespace
}  // namespace renderer

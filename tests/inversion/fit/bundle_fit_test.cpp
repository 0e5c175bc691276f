// Bundles drawn at random, photographed by the path tracer and fitted as if nothing were known of them. Their number of
// fibers and packing are among those that a fit tries. THREADSTATION_BUNDLES in the environment says how many there
// are, THREADSTATION_SEED from which seed they are drawn.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdio>
#include <random>

#include "inversion/fit/fit_views.h"
#include "inversion/view/agreement.h"
#include "tests/inversion/fit/synthetic_spool.h"
#include "tests/support/asked.h"

namespace inversion {
namespace {

constexpr int kWidth_px = 96, kSamples = 192;
constexpr int kSeed = 20261125, kBundles = 2;

renderer::BundleParameters random_bundle(std::mt19937& random) {
  const auto between = [&](double low, double high) { return std::uniform_real_distribution(low, high)(random); };
  const auto one_of = [&](const auto& choices) {
    return choices[std::uniform_int_distribution<std::size_t>(0, choices.size() - 1)(random)];
  };
  renderer::BundleParameters bundle{.fiber_count = one_of(kBundleFiberCounts)};
  bundle.radius_ratio = std::sqrt(one_of(kBundlePackings) / bundle.fiber_count);
  for (int c = 0; c < 3; ++c) bundle.fiber.sigma_a[c] = std::exp(between(std::log(0.03), std::log(1.5)));
  bundle.fiber.beta_m = between(0.25, 0.7);
  bundle.fiber.beta_n = between(0.25, 0.7);
  return bundle;
}

double packing_of(const renderer::BundleParameters& bundle) {
  return bundle.fiber_count * bundle.radius_ratio * bundle.radius_ratio;
}

Eigen::VectorXd unknowns_of(const renderer::FiberParameters& fiber) {
  Eigen::VectorXd unknowns(5);
  unknowns << fiber.sigma_a, fiber.beta_m, fiber.beta_n;
  return unknowns;
}

TEST(BundleFitTest, BundlesDrawnAtRandomAreFoundAndPredictAViewThatWasLeftOut) {
  const int bundles = asked("THREADSTATION_BUNDLES", kBundles), seed = asked("THREADSTATION_SEED", kSeed);
  ASSERT_GT(bundles, 0);
  const WrappedSpool spool;
  std::printf("seed %d\n", seed);
  std::mt19937 random(static_cast<std::uint32_t>(seed));
  for (int i = 0; i < bundles; ++i) {
    const renderer::BundleParameters truth = random_bundle(random);
    const std::vector<View> views = photographs(spool, truth, kWidth_px, kSamples);
    const Standpoint apart{"upright-25", 0, 25, -20, 10, true};
    const View left_out = unlit_view(spool, apart, kWidth_px);
    const auto halves = [&](const renderer::ScatteringModel& model, std::uint64_t first) {
      return std::array{fitted_view(spool, left_out, model, kSamples, first),
                        fitted_view(spool, left_out, model, kSamples, first + 1)};
    };
    const ViewFit fit = fit_views(spool, views, {.model = ModelKind::bundle, .seed = 1 + static_cast<unsigned>(i)});
    const auto& found = std::get<renderer::BundleParameters>(fit.model);
    const ViewAgreement seen = noiseless_agreement(left_out, halves(truth, 5), halves(fit.model, 99), fit.block_px);
    std::printf("%d fibers, packed %.2f; found %d, %.2f; left out %.2f %%\n", truth.fiber_count, packing_of(truth),
                found.fiber_count, packing_of(found), 100 * seen.relative_rmse());
    const Eigen::VectorXd wanted = unknowns_of(truth.fiber);
    const bool same = found.fiber_count == truth.fiber_count && std::abs(packing_of(found) - packing_of(truth)) < 1e-6;
    for (Eigen::Index k = 0; k < wanted.size(); ++k) {
      const double deviation = std::sqrt(fit.certainty.noise_covariance(k, k));
      std::printf("  %-9s %.4f +- %.4f, truth %.4f (%+.1f deviations)\n",
                  fit.unknown_names[static_cast<std::size_t>(k)].c_str(), fit.unknowns[k], deviation, wanted[k],
                  (fit.unknowns[k] - wanted[k]) / deviation);
      if (same) EXPECT_NEAR(fit.unknowns[k], wanted[k], 4 * deviation) << k;
    }
    std::fflush(stdout);
    EXPECT_LT(seen.relative_rmse(), 0.04);
  }
}

}  // namespace
}  // namespace inversion

// The baselines on data of their own, and the two solvers on the same data.
#include <gtest/gtest.h>

#include "inversion/fit/fit_views.h"
#include "inversion/fit/independent_loss.h"
#include "inversion/view/agreement.h"
#include "tests/inversion/fit/synthetic_spool.h"

namespace inversion {
namespace {

constexpr int kWidth_px = 72, kSamples = 256;

TEST(BaselinesTest, AFiberIsRecoveredFromItsPictures) {
  const WrappedSpool spool;
  const renderer::FiberParameters truth{.sigma_a = {0.2, 0.5, 1.2}, .beta_m = 0.35, .beta_n = 0.5};
  const ViewFit fit = fit_views(spool, photographs(spool, truth, kWidth_px, kSamples), {.model = ModelKind::fiber});
  const auto& found = std::get<renderer::FiberParameters>(fit.model);
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(found.sigma_a[c], truth.sigma_a[c], 0.02 * truth.sigma_a[c]) << c;
  EXPECT_NEAR(found.beta_m, truth.beta_m, 0.01);
  EXPECT_NEAR(found.beta_n, truth.beta_n, 0.02);
}

TEST(BaselinesTest, AYarnIsRecoveredWithItsNumberOfFibers) {
  const WrappedSpool spool;
  const renderer::YarnParameters truth{.fiber_count = 10,
                                       .radius_ratio = std::sqrt(kYarnPacking / 10),
                                       .sigma_a = {0.2, 0.5, 1.2},
                                       .beta_r = 0.4,
                                       .beta_tt = 0.25,
                                       .gamma_tt = 0.4};
  const ViewFit fit = fit_views(spool, photographs(spool, truth, kWidth_px, kSamples),
                                {.model = ModelKind::yarn, .paths_per_block = {64, 128, 512}});
  const auto& found = std::get<renderer::YarnParameters>(fit.model);
  EXPECT_EQ(found.fiber_count, 10);
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(found.sigma_a[c], truth.sigma_a[c], 0.05 * truth.sigma_a[c]) << c;
  EXPECT_NEAR(found.beta_tt, truth.beta_tt, 0.02);
}

TEST(BaselinesTest, LevenbergMarquardtsFirstRoundGetsAtLeastAsFarAsAHundredStepsOfAdam) {
  const WrappedSpool spool;
  const std::vector<View> views = photographs(spool, known_thread(), kWidth_px, kSamples);
  const ViewFit whole = fit_views(spool, views, {.other_starts = {}}),
                first = fit_views(spool, views, first_rounds({}, 1)),
                adam = fit_views(spool, views, {.solver = Solver::adam, .adam_paths = 256});
  EXPECT_EQ(first.rounds.size(), 1U);
  EXPECT_EQ(adam.rounds.front().losses.size(), 101U);
  EXPECT_LT(adam.loss(), 0.2 * adam.rounds.front().loss_before);  // it does go down
  const auto loss_of = [&](const char* name, const ViewFit& fit) {
    const IndependentLoss loss = independent_loss(spool, views, fit, 4096, 3, 901);
    std::printf("%s: loss on other paths %.3g +- %.1g\n", name, loss.mean, loss.standard_error);
    return loss.mean;
  };
  const double by_adam = loss_of("Adam", adam);
  EXPECT_LE(loss_of("Levenberg-Marquardt", whole), by_adam);
  EXPECT_LE(loss_of("its first round", first), by_adam);
}

}  // namespace
}  // namespace inversion

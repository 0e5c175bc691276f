// The baselines on data of their own, and the two solvers on the same data.
#include <gtest/gtest.h>

#include "inversion/agreement.h"
#include "inversion/fit_views.h"
#include "inversion/view_objective.h"
#include "synthetic_spool.h"

namespace inversion {
namespace {

std::vector<View> photographs(const WrappedSpool& spool, const renderer::ScatteringModel& model) {
  constexpr int kWidth_px = 72, kSamples = 256;
  std::vector<View> views;
  for (const Standpoint& at : six_standpoints()) {
    views.push_back(unlit_view(spool, at, kWidth_px));
    views.back().image = fitted_view(spool, views.back(), model, kSamples, 5 + views.size());
  }
  return views;
}

TEST(BaselinesTest, AFiberIsRecoveredFromItsPictures) {
  const WrappedSpool spool;
  const renderer::FiberParameters truth{.sigma_a = {0.2, 0.5, 1.2}, .beta_m = 0.35, .beta_n = 0.5};
  const ViewFit fit = fit_views(spool, photographs(spool, truth), {.model = ModelKind::fiber});
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
  const ViewFit fit =
      fit_views(spool, photographs(spool, truth), {.model = ModelKind::yarn, .paths_per_block = {64, 128, 512}});
  const auto& found = std::get<renderer::YarnParameters>(fit.model);
  EXPECT_EQ(found.fiber_count, 10);
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(found.sigma_a[c], truth.sigma_a[c], 0.05 * truth.sigma_a[c]) << c;
  EXPECT_NEAR(found.beta_tt, truth.beta_tt, 0.02);
}

// Eq. 6's loss without the trend's rounding apart: both solvers have the same parametrisation, bounds and penalties.
double loss_on_other_paths(const WrappedSpool& spool, const std::vector<View>& views, const ViewFit& fit,
                           std::uint64_t seed) {
  const auto family = thread_family();
  ViewObjective objective(spool, views, *family);
  objective.trace(fit.unknowns, 4096, seed, [](int, int) {});
  Eigen::VectorXd residuals(objective.residual_count());
  objective.residuals(fit.unknowns, residuals.data(), nullptr);
  return 0.5 * residuals.squaredNorm();
}

TEST(BaselinesTest, LevenbergMarquardtGetsAtLeastAsFarAsAHundredStepsOfAdam) {
  const WrappedSpool spool;
  const std::vector<View> views = photographs(spool, known_thread());
  const ViewFit fast = fit_views(spool, views, {}),
                adam = fit_views(spool, views, {.solver = Solver::adam, .adam_paths = 256});
  EXPECT_EQ(adam.rounds.front().losses.size(), 101U);
  EXPECT_LT(adam.loss(), 0.2 * adam.rounds.front().loss_before);  // it does go down
  double fast_loss = 0, adam_loss = 0;
  for (std::uint64_t seed : {901, 902, 903}) {
    fast_loss += loss_on_other_paths(spool, views, fast, seed) / 3;
    adam_loss += loss_on_other_paths(spool, views, adam, seed) / 3;
  }
  std::printf("loss on other paths: Levenberg-Marquardt %.3g, Adam %.3g\n", fast_loss, adam_loss);
  EXPECT_LE(fast_loss, adam_loss);
}

}  // namespace
}  // namespace inversion

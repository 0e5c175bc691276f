// Recovered truth: pictures of a known thread, fitted from the start that every fit has.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "inversion/fit/energy_bands.h"
#include "inversion/fit/fit_family.h"
#include "inversion/fit/fit_views.h"
#include "inversion/fit/independent_loss.h"
#include "inversion/fit/thread_unknowns.h"
#include "inversion/view/agreement.h"
#include "tests/inversion/fit/synthetic_spool.h"

namespace inversion {
namespace {

constexpr int kWidth_px = 120, kSamples = 48;

std::vector<ViewAgreement> agreements(const WrappedSpool& spool, const std::vector<View>& views, const ViewFit& fit) {
  std::vector<ViewAgreement> found;
  for (const View& view : views) {
    const cv::Mat3f rendered = fitted_view(spool, view, fit.thread(), kSamples, 99 + found.size());
    found.push_back(agreement(view, rendered, fit.block_px));
  }
  return found;
}

// The share of light, RGB, that leaves a thread again after entering along its radius at cosine c to its normal plane.
renderer::Rgb<double> albedo(const renderer::ThreadParameters& thread, double c) {
  const renderer::ThreadModel<double> model(thread);
  const renderer::Vec3<double> along(std::sqrt(1 - c * c), 0, c);
  return model.lobes_at(0, along).attenuation.colwise().sum().transpose();
}

TEST(FitRecoveryTest, AKnownThreadIsRecoveredFromItsPictures) {
  const WrappedSpool spool;
  const std::vector<View> views = photographs(spool, known_thread(), kWidth_px, kSamples);
  const FitOptions options{.other_starts = {}, .paths_per_block = {256, 1024, 4096}};
  const ViewFit fit = fit_views(spool, views, options);

  // Pictures: measured 0.7 % overall, of which the noise of both renderings makes 0.6 %.
  const std::vector<ViewAgreement> found = agreements(spool, views, fit);
  for (std::size_t i = 0; i < views.size(); ++i) EXPECT_LT(found[i].relative_rmse(), 0.03) << views[i].id;
  EXPECT_LT(overall_relative_rmse(found), 0.015);

  // Transmission can be strong and absorbed or weak and not: r1a and the colours' common part of sigma_a trade places
  // at almost no loss. Four seeds gave 0 .. 0.10 for 0.15; differences between colours stay within 6 %.
  const renderer::ThreadParameters &fitted = fit.thread(), known = known_thread();
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(fitted.sigma_a[c], known.sigma_a[c], 0.2) << c;
  for (int c = 1; c < 3; ++c) {
    const double difference = known.sigma_a[c] - known.sigma_a[0];
    EXPECT_NEAR(fitted.sigma_a[c] - fitted.sigma_a[0], difference, 0.12 * difference) << c;
  }
  // What the lobes keep together is not affected: within 2 % for this seed, 4 % for four.
  for (double c : {0.7, 0.85, 1.0})
    for (int channel = 0; channel < 3; ++channel)
      EXPECT_NEAR(albedo(fitted, c)[channel] / albedo(known, c)[channel], 1, 0.05) << channel << " at c = " << c;
  // Reflection does not pass the thread (four seeds: within 9 %); near c = 0 no view sees it.
  for (double c : {0.85, 0.95, 1.0})
    EXPECT_NEAR(energies_at(fitted, c)[0] / energies_at(known, c)[0], 1, 0.2) << "at c = " << c;
  for (std::size_t p = 0; p < 3; ++p) EXPECT_NEAR(fitted.alpha[p], known.alpha[p], 0.08) << p;

  for (int c = 0; c < 3; ++c)
    std::printf("sigma_a[%d] %.3f +- %.3f, truth %.3f\n", c, fitted.sigma_a[c],
                std::sqrt(fit.certainty.covariance(c, c)), known.sigma_a[c]);
  for (const EnergyBand& band : energy_bands(fit)) {
    const auto truth = energies_at(known, band.cosine);
    for (std::size_t p = 0; p < 3; ++p)
      std::printf("lambda_%zu(%.1f) %.4f +- %.4f, truth %.4f\n", p, band.cosine, band.lambda[p], band.sigma[p],
                  truth[p]);
  }
}

TEST(FitRecoveryTest, HoldingAnyGroupAtItsStartMakesTheMisfitClearlyWorse) {
  const WrappedSpool spool;
  const std::vector<View> views = photographs(spool, known_thread(), kWidth_px, kSamples);
  FitOptions options{.other_starts = {}, .paths_per_block = {128, 512}};
  const auto misfit = [&] { return independent_loss(spool, views, fit_views(spool, views, options), 2048, 2, 77); };
  const IndependentLoss free = misfit();
  const double least = std::max(free.without_noise, free.standard_error);
  for (ParameterGroup group : kParameterGroups) {
    options.held = {group};
    const double held = misfit().without_noise;
    std::printf("%s held: %.1f times the misfit\n", name_of(group).c_str(), held / least);
    EXPECT_GT(held, 4 * least) << name_of(group);
  }
}

TEST(FitRecoveryTest, TheTintOfAMetallicThreadsHighlightIsFound) {
  const WrappedSpool spool;
  renderer::ThreadParameters metal = known_thread();
  metal.sigma_a = {0.3, 0.7, 2.5};
  metal.lambda0_rgb = {1, 0.76, 0.34};
  FitOptions options{.other_starts = {}, .paths_per_block = {256, 256, 1024}};
  options.tinted = true;
  const ViewFit fit = fit_views(spool, photographs(spool, metal, kWidth_px, kSamples), options);
  const renderer::Vec3<double> found = fit.thread().lambda0_rgb;
  std::printf("tint %.3f %.3f %.3f\n", found[0], found[1], found[2]);
  EXPECT_EQ(found[0], 1);
  EXPECT_NEAR(found[1], metal.lambda0_rgb[1], 0.05);
  EXPECT_NEAR(found[2], metal.lambda0_rgb[2], 0.05);
}

// Noise leads a search into a lobe so narrow that few paths say how wide it should be, and it stays there. The nearer
// of these two begins in one; the other is nowhere near.
TEST(FitRecoveryTest, ALobeThatASearchHasMadeFarTooNarrowIsWidenedAgain) {
  const WrappedSpool spool;
  renderer::ThreadParameters metal = known_thread();
  metal.alpha = {0.12, 0.2, 0.22};
  metal.beta[0] = 0.4;
  metal.lambda0_rgb = {1, 0.76, 0.34};
  FitOptions options{.paths_per_block = {2048}};
  options.robust = false;
  options.tinted = true;
  const ThreadFamily family{metal.exit, metal.transmittance_powers, true};
  Eigen::VectorXd narrow = tinted_unknowns_of(metal), far = tinted_unknowns_of(options.start);
  narrow[kBeta] = unknowns_of(ScatteringFamily(family)).lower[kBeta];
  far.segment<3>(kAlpha) = unknowns_of(ScatteringFamily(family)).upper.segment<3>(kAlpha);
  const ViewFit fit = fit_family(spool, photographs(spool, metal, 72, 256), options, family, {far, narrow});
  std::printf("start %d, beta_R %.3f\n", fit.start, fit.unknowns[kBeta]);
  EXPECT_NEAR(fit.unknowns[kBeta], metal.beta[0], 0.1);
}

TEST(FitRecoveryTest, AWhiteThreadThatKeepsNearlyAllLightIsFittedWithoutEnergyBeyondOne) {
  const WrappedSpool spool;
  const ViewFit fit = fit_views(spool, photographs(spool, white_thread(), kWidth_px, kSamples), {.other_starts = {}});
  double most = 0;
  for (int k = 0; k <= 10000; ++k) {
    const auto lambda = energies_at(fit.thread(), k / 10000.0);
    most = std::max(most, lambda[0] + lambda[1] + lambda[2]);
  }
  EXPECT_LT(most, 1.01);  // a penalty, no bound; measured 0.99 here and 1.0001 for other seeds
}

}  // namespace
}  // namespace inversion

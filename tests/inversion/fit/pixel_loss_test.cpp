// The paper's recipe: its loss by pixels against pictures of the path tracer, its hinges, and its fit.
#include "inversion/fit/pixel_loss.h"

#include <gtest/gtest.h>

#include <opencv2/core.hpp>

#include "inversion/fit/fit_views.h"
#include "inversion/fit/independent_loss.h"
#include "inversion/fit/light_paths.h"
#include "inversion/fit/loss_terms.h"
#include "inversion/view/agreement.h"
#include "tests/inversion/fit/synthetic_spool.h"

namespace inversion {
namespace {

using Eigen::VectorXd;

// A thread of the family with every lobe at work.
renderer::ThreadParameters thread_of_the_paper() {
  renderer::ThreadParameters p = known_thread();
  p.exit = renderer::ThreadExit::entry_point;
  p.limit_energy = false;
  return p;
}

VectorXd printed(const renderer::ThreadParameters& p) {
  VectorXd u(renderer::kThreadParameterCount);
  u << p.sigma_a, p.alpha[0], p.alpha[1], p.alpha[2], p.beta[0], p.beta[1], p.beta[2], p.r0a, p.r0b, p.r0c, p.r1a,
      p.r2a, p.r2b, p.r2c;
  return u;
}

std::vector<View> two_views(const WrappedSpool& spool, int width_px, int samples) {
  std::vector<View> views;
  for (const std::size_t i : {std::size_t{0}, std::size_t{4}})
    views.push_back(photographed(unlit_view(spool, six_standpoints()[i], width_px), spool, thread_of_the_paper(),
                                 samples, 900 + i));
  return views;
}

// Eq. 6's sum over pictures of the path tracer.
double loss_of_pictures(const WrappedSpool& spool, const std::vector<View>& views, const VectorXd& unknowns) {
  constexpr int kSamples = 2048;
  double loss = 0;
  for (const View& view : views) {
    const cv::Mat3f picture = fitted_view(spool, view, model_at(PaperFamily{}, unknowns), kSamples, 5);
    const double off = cv::norm(picture, view.image, cv::NORM_L2, view.mask) / diffuser_radiance(view.light).mean();
    loss += off * off / cv::countNonZero(view.mask);
  }
  return loss;
}

struct Mean {
  double loss = 0;
  VectorXd gradient;
};

Mean mean_over_seeds(const PixelLoss& pixels, const VectorXd& unknowns, int paths, int seeds) {
  Mean mean{.gradient = VectorXd::Zero(unknowns.size())};
  VectorXd gradient;
  for (int seed = 0; seed < seeds; ++seed) {
    mean.loss += pixels.at(unknowns, paths, 77000003ULL * static_cast<std::uint64_t>(seed + 1), gradient) / seeds;
    mean.gradient += gradient / seeds;
  }
  return mean;
}

TEST(PixelLossTest, IsThatOfRenderedPicturesAndSoIsItsGradient) {
  const WrappedSpool spool;
  const std::vector<View> views = two_views(spool, 24, 4096);
  const PixelLoss pixels(spool, views, PaperFamily{});
  VectorXd at = printed(thread_of_the_paper());
  at.head<3>() *= 1.4;
  at[kR0c] += 0.1, at[kR1] -= 0.15, at[kBeta + 1] += 0.1;
  const Mean mean = mean_over_seeds(pixels, at, 64, 12);
  EXPECT_NEAR(mean.loss / loss_of_pictures(spool, views, at), 1, 0.03);
  for (const int k : {static_cast<int>(kSigma), static_cast<int>(kR0c), static_cast<int>(kR1)}) {
    const double step = 0.1 * at[k];
    VectorXd up = at, down = at;
    up[k] += step, down[k] -= step;
    const double slope = (loss_of_pictures(spool, views, up) - loss_of_pictures(spool, views, down)) / (2 * step);
    EXPECT_NEAR(mean.gradient[k] / slope, 1, 0.06) << k;
  }
}

TEST(PixelLossTest, HasNoPartOfThePathsNoise) {
  const WrappedSpool spool;
  const std::vector<View> views = two_views(spool, 24, 4096);
  const PixelLoss pixels(spool, views, PaperFamily{});
  const VectorXd truth = printed(thread_of_the_paper());
  VectorXd darker = truth, gradient;
  darker[kR0c] *= 0.9;
  // Pictures of 8 paths a pixel are noisier than what a tenth of a lobe changes.
  EXPECT_LT(std::abs(mean_over_seeds(pixels, truth, 8, 40).loss), 0.3 * mean_over_seeds(pixels, darker, 64, 12).loss);
  EXPECT_THROW(pixels.at(truth, 3, 1, gradient), std::invalid_argument);
}

// The hinges' corners are rounded within a thousandth: half of that is missing of each.
TEST(PaperFamilyTest, PaysTheHingesOfEquation6AndNothingElse) {
  OtherTerms terms(PaperFamily{}, 0);
  VectorXd u = printed(thread_of_the_paper());
  EXPECT_EQ(terms.at(u).loss, 0);
  u[kR0a] = 0.2, u[kR0b] = 0.3, u[kR0c] = 3, u[kR2b] = -0.5;  // energies far above 1 cost nothing
  const BiasFreeTerms paid = terms.at(u);
  EXPECT_NEAR(paid.loss, 1e-4 * ((0.2 + 0.3) + 0.5 + 0.2), 1e-4 * 3 * 0.0005 + 1e-12);
  EXPECT_NEAR(paid.gradient[kR0a], 2e-4, 1e-12);
  EXPECT_NEAR(paid.gradient[kR0b], 1e-4, 1e-12);
  EXPECT_NEAR(paid.gradient[kR2b], -1e-4, 1e-12);
  EXPECT_EQ(paid.gradient[kR0c], 0);
}

TEST(PaperFamilyTest, IsFittedByAHundredStepsOfAdamFromTheOneStart) {
  const WrappedSpool spool;
  const std::vector<View> views = two_views(spool, 36, 256);
  const ViewFit fit = fit_views(spool, views, {.model = ModelKind::paper, .adam_paths = 256});
  ASSERT_EQ(fit.rounds.size(), 1U);
  const FitRound& round = fit.rounds.front();
  EXPECT_EQ(round.losses.size(), 101U);
  EXPECT_LT(round.loss_after, 0.2 * round.loss_before);
  EXPECT_EQ(fit.thread().exit, renderer::ThreadExit::entry_point);
  EXPECT_NEAR(fit.thread().r2a, starting_thread().r2a, 1.01);  // a step of Adam is hardly above its rate
  EXPECT_EQ(fit.unknown_names[kR2c], "r2c");
  EXPECT_LT(independent_loss(spool, views, fit, 1024, 3, 17).without_noise, 0.2 * round.loss_before);
}

}  // namespace
}  // namespace inversion

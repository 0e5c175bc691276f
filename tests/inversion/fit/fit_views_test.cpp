#include "inversion/fit/fit_views.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <stdexcept>

#include "inversion/fit/effort.h"
#include "tests/inversion/fit/synthetic_spool.h"

namespace inversion {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;
using testing::ThrowsMessage;

auto refuses_with(const std::string& part) {
  return ThrowsMessage<std::runtime_error>(AllOf(HasSubstr(part), Not(HasSubstr("\n"))));
}

class FitViewsTest : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    views_ = new std::vector<View>;
    for (const Standpoint& at : {six_standpoints()[0], six_standpoints()[4]})
      views_->push_back(photographed(unlit_view(kSpool, at, 60), kSpool, known_thread(), 16, 5));
  }
  static void TearDownTestSuite() { delete views_; }

  static ViewFit quick_fit(const std::vector<View>& views, FitOptions options = {}) {
    options.paths_per_block = {32, 64};
    return fit_views(kSpool, views, options);
  }

  static ThreadUnknowns quick_unknowns(FitOptions options = {}) {
    return unknowns_of(quick_fit(*views_, std::move(options)).thread());
  }

  inline static const WrappedSpool kSpool{};
  inline static std::vector<View>* views_ = nullptr;
};

TEST_F(FitViewsTest, TheSameSeedGivesTheSameThreadOnAnyNumberOfThreads) {
  const ThreadUnknowns first = quick_unknowns();
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  EXPECT_EQ(quick_unknowns(), first);
  FitOptions other;
  other.seed = 2;
  EXPECT_NE(quick_unknowns(other), first);
}

TEST_F(FitViewsTest, TheLossFallsInEveryRoundAndTheRoundsAreThoseAskedFor) {
  const ViewFit fit = quick_fit(*views_);
  ASSERT_EQ(fit.rounds.size(), 2U);
  EXPECT_EQ(fit.rounds[0].paths_per_block, 32);
  EXPECT_EQ(fit.rounds[1].paths_per_block, 64);
  for (const FitRound& round : fit.rounds) EXPECT_LE(round.loss_after, round.loss_before);
  EXPECT_LT(fit.rounds[0].loss_after, 0.05 * fit.rounds[0].loss_before);  // measured: 0.007
  EXPECT_GT(fit.rounds[0].steps, 1);
}

TEST_F(FitViewsTest, EnergyBeyondOneIsTakenBackEvenWhereNoViewSeesIt) {
  FitOptions options;
  options.start.r2a = 2000, options.start.r2b = 0.1;  // lambda_2 is 10 at c = 0 and below 0.1 from c = 0.005 on
  const renderer::ThreadParameters fitted = quick_fit(*views_, options).thread();
  EXPECT_TRUE(fitted.limit_energy);
  for (int k = 0; k <= 1000; ++k) {
    const auto lambda = energies_at(fitted, k / 1000.0);
    // So few paths leave noise that pulls against the penalty: measured 1.000.
    EXPECT_LT(lambda[0] + lambda[1] + lambda[2], 1.02) << "at c = " << k / 1000.0;
  }
}

TEST_F(FitViewsTest, HeldGroupsStayAtTheirStart) {
  const ThreadUnknowns start = unknowns_of(starting_thread());
  for (ParameterGroup group : kParameterGroups) {
    FitOptions options;
    options.held = {group};
    const ThreadUnknowns fitted = quick_unknowns(options);
    for (int k = 0; k < renderer::kThreadParameterCount; ++k)
      if (group_of(k) == group) EXPECT_NEAR(fitted[k], start[k], 1e-12) << k << " of " << name_of(group);
    EXPECT_GT((fitted - start).cwiseAbs().maxCoeff(), 0.01);
  }
}

TEST_F(FitViewsTest, AFitWithEverythingHeldKeepsTheStart) {
  FitOptions options;
  options.held = {kParameterGroups.begin(), kParameterGroups.end()};
  options.start = known_thread();
  EXPECT_TRUE(quick_unknowns(options).isApprox(unknowns_of(known_thread()), 1e-12));
}

TEST_F(FitViewsTest, ProgressNeverGoesBackAndNamesTheRound) {
  FitOptions options;
  double last = 0;
  std::string words;
  options.progress = [&](const std::string& what, double share) {
    EXPECT_GE(share, last);
    EXPECT_LE(share, 1);
    last = share;
    words += what + "; ";
    return true;
  };
  quick_fit(*views_, options);
  EXPECT_THAT(words, AllOf(HasSubstr("start 1, round 1 of 2, tracing"), HasSubstr("round 2 of 2, step 1")));
  last = 0;
  options.paths_per_block = {32, kFewestPathsWithoutBias};
  fit_views(kSpool, *views_, options);
  EXPECT_THAT(words, AllOf(HasSubstr("comparing starts"), HasSubstr("without bias, step 2")));
  EXPECT_GT(last, 0.9);
}

TEST_F(FitViewsTest, AFitIsStoppedOnRequestWhileTracingAndBetweenSteps) {
  for (const std::string moment :
       {"start 1, round 1 of 2, tracing", "start 1, round 1 of 2, step 1", "start 1, round 2 of 2, step 0"}) {
    FitOptions options;
    options.other_starts.clear();  // the last round is start 1's
    options.progress = [&](const std::string& what, double) { return what != moment; };
    EXPECT_THAT([&] { quick_fit(*views_, options); }, refuses_with("the fit was stopped on request")) << moment;
  }
}

TEST_F(FitViewsTest, NoRoundsAndARoundWithoutPathsAreRefused) {
  for (const std::vector<int>& paths : {std::vector<int>{}, {32, 0}}) {
    FitOptions options;
    options.paths_per_block = paths;
    EXPECT_THROW(fit_views(kSpool, *views_, options), std::invalid_argument);
  }
}

TEST_F(FitViewsTest, NoViewsAreRefused) {
  EXPECT_THAT([&] { quick_fit({}); }, refuses_with("there is no view to fit a thread to"));
}

TEST_F(FitViewsTest, AnEmptyMaskIsRefusedByTheViewsName) {
  std::vector<View> views = *views_;
  views[1].mask = cv::Mat1b(views[1].image.size(), std::uint8_t{0});
  EXPECT_THAT([&] { quick_fit(views); }, refuses_with("view through-0: the mask is empty"));
}

TEST_F(FitViewsTest, APictureThatIsMissingOrOfAnotherSizeIsRefused) {
  for (const cv::Mat3f& picture : {cv::Mat3f(), cv::Mat3f(3, 4, cv::Vec3f(1, 1, 1))}) {
    std::vector<View> views = *views_;
    views[0].image = picture;
    EXPECT_THAT([&] { quick_fit(views); },
                refuses_with("view lying-0: the picture is missing or differs in size from its mask"));
  }
}

TEST_F(FitViewsTest, ALampWithoutIntensityInAnyColourIsRefused) {
  std::vector<View> views = *views_;
  views[0].light.intensity[2] = 0;
  EXPECT_THAT([&] { quick_fit(views); }, refuses_with("view lying-0: the lamp has no intensity"));
}

}  // namespace
}  // namespace inversion

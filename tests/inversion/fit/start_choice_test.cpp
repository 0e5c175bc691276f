#include "inversion/fit/start_choice.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "inversion/fit/thread_unknowns.h"
#include "inversion/fit/view_objective.h"
#include "tests/inversion/fit/synthetic_spool.h"

namespace inversion {
namespace {

using Eigen::VectorXd;

class StartChoiceTest : public testing::Test {
 protected:
  static void SetUpTestSuite() { views_ = new std::vector<View>(photographs(kSpool, known_thread(), 48, 64)); }
  static void TearDownTestSuite() { delete views_; }

  StartChoiceTest() {
    options_.paths_per_block = {512};
    options_.robust = false;
  }

  NearestSearch nearest(const std::vector<VectorXd>& starts) { return nearest(starts, *views_); }
  NearestSearch nearest(const std::vector<VectorXd>& starts, const std::vector<View>& views) {
    std::vector<Attempt> attempts;
    for (const VectorXd& start : starts)
      attempts.push_back({.start = static_cast<int>(attempts.size()), .unknowns = start});
    const Search search{
        .family = &family_, .options = &options_, .effort = {}, .unknowns = unknowns_of(family_), .held = held_};
    const ViewObjective objective(kSpool, views, family_);
    Work work(options_, work_of_choice(search, objective.block_count(), starts.size()));
    return nearest_search(kSpool, views, objective.block_count(), search, std::move(attempts), work);
  }

  inline static const WrappedSpool kSpool{};
  inline static std::vector<View>* views_ = nullptr;
  ScatteringFamily family_ = ThreadFamily{};
  FitOptions options_;
  std::vector<int> held_;
};

TEST_F(StartChoiceTest, TheSearchThatIsNearestIsTakenWithHowUncertainItIs) {
  VectorXd far = unknowns_of(known_thread());
  far.segment<3>(kBeta).setConstant(0.1);
  const Attempt found = nearest({far, unknowns_of(known_thread())}).nearest;
  EXPECT_EQ(found.start, 1);
  ASSERT_EQ(found.covariance.rows(), far.size());
  EXPECT_GT(found.covariance.diagonal().minCoeff(), 0);
}

TEST_F(StartChoiceTest, ItTriesTheNearestOnceMoreWithRAndTRTExchangedAndItsProgressNeverGoesBack) {
  double last = 0;
  std::set<std::string> searches;
  options_.progress = [&](const std::string& what, double share) {
    EXPECT_GE(share, last);
    last = share;
    searches.insert(what.substr(0, what.find(',')));
    return true;
  };
  nearest({unknowns_of(known_thread())});
  EXPECT_THAT(searches, testing::ElementsAre("R and TRT exchanged", "comparing starts", "start 1"));
  EXPECT_GT(last, 0.9);
  EXPECT_LE(last, 1);
}

TEST_F(StartChoiceTest, AnExchangeOfRAndTRTThatGoesBackIsNotPursued) {
  EXPECT_FALSE(nearest({unknowns_of(known_thread())}).exchanged);
}

// Widths are held, so that each search stays in its place.
TEST_F(StartChoiceTest, UnderATintASearchThatLiesWhereRAndTRTAreExchangedIsGoneOnWithToo) {
  renderer::ThreadParameters metal = known_thread();
  metal.sigma_a = {0.3, 0.7, 2.5};
  metal.alpha = {0.12, 0.2, 0.22};
  metal.lambda0_rgb = {1, 0.76, 0.34};
  options_.tinted = true;
  family_ = ThreadFamily{options_.start.exit, options_.start.transmittance_powers, true};
  const VectorXd truth = tinted_unknowns_of(metal);
  VectorXd exchanged = truth;
  exchanged[kAlpha] = truth[kAlpha + 2], exchanged[kAlpha + 2] = truth[kAlpha];
  held_ = {kAlpha, kAlpha + 1, kAlpha + 2};
  const NearestSearch found = nearest({exchanged, truth}, photographs(kSpool, metal, 48, 64));
  EXPECT_EQ(found.nearest.start, 1);
  ASSERT_TRUE(found.exchanged);
  EXPECT_EQ(found.exchanged->start, 0);
}

TEST_F(StartChoiceTest, ItIsStoppedOnRequest) {
  options_.progress = [&](const std::string& what, double) { return what != "comparing starts"; };
  EXPECT_THROW(nearest({unknowns_of(known_thread())}), std::runtime_error);
}

TEST(LightenBlackestTest, AColourThatHasBecomeBlackIsSeenAgainUnlessItIsHeld) {
  const ScatteringFamily family = ThreadFamily{};
  const FitOptions options;
  Search search{.family = &family, .options = &options, .effort = {}, .unknowns = unknowns_of(family)};
  VectorXd unknowns = unknowns_of(known_thread());
  const double green = unknowns[1];
  unknowns[2] = 20;
  VectorXd held = unknowns;
  lighten_blackest(search, unknowns);
  EXPECT_EQ(unknowns[1], green);
  EXPECT_LE(unknowns[2], 3);
  search.held = {0, 1, 2};
  lighten_blackest(search, held);
  EXPECT_EQ(held[2], 20);
}

}  // namespace
}  // namespace inversion

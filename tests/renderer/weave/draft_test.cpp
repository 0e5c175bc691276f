#include "renderer/weave/draft.h"

#include <gtest/gtest.h>

#include <functional>
#include <limits>

#include "renderer/weave/initial_patch.h"
#include "renderer/weave/patch.h"

namespace renderer {
namespace {

std::vector<Draft> ready_drafts() {
  return {plain_draft(),     twill_draft(2, 2), twill_draft(3, 1), twill_draft(1, 3),
          satin_draft(5, 2), satin_draft(8, 3), basket_draft(2)};
}

TEST(DraftTest, ReadyWeavesCanBeWoven) {
  for (const Draft& draft : ready_drafts()) EXPECT_EQ(check_draft(draft).value_or("fine"), "fine") << draft.name;
}

TEST(DraftTest, TwillMovesByOneEndFromPickToPick) {
  const Draft twill = twill_draft(3, 1);
  for (std::size_t pick = 0; pick < 4; ++pick)
    for (std::size_t end = 0; end < 4; ++end)
      EXPECT_EQ(twill.warp_over[pick][end], twill.warp_over[(pick + 1) % 4][(end + 1) % 4]);
}

TEST(DraftTest, SatinBindsEachYarnOnceAndNowhereBesideAnotherBinding) {
  for (const Draft& satin : {satin_draft(5, 2), satin_draft(8, 3)}) {
    const std::size_t n = satin.warp_over.size();
    for (std::size_t pick = 0; pick < n; ++pick) {
      int in_pick = 0, in_end = 0;
      for (std::size_t k = 0; k < n; ++k) {
        in_pick += !satin.warp_over[pick][k];
        in_end += !satin.warp_over[k][pick];
        if (satin.warp_over[pick][k]) continue;
        for (std::size_t step : {n - 1, std::size_t{1}}) EXPECT_TRUE(satin.warp_over[(pick + 1) % n][(k + step) % n]);
      }
      EXPECT_EQ(in_pick, 1);
      EXPECT_EQ(in_end, 1);
    }
  }
}

TEST(DraftTest, ThePatchIsTheLeastCommonMultipleOfStructureAndThreadOrder) {
  Draft draft = twill_draft(2, 2);
  draft.warp.threads = {0, 0, 1, 1, 2, 2};
  draft.weft.threads = {3, 4, 5};
  EXPECT_EQ(ends_in_patch(draft), 12);
  EXPECT_EQ(picks_in_patch(draft), 12);
  draft.weft.threads = {3, 3, 4, 4};
  EXPECT_EQ(picks_in_patch(draft), 4);
}

struct BadDraft {
  std::function<void(Draft&)> spoil;
  std::string named;  // what the line must name
};

TEST(DraftTest, EachBadDraftIsRefusedInOneLineThatNamesTheFault) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const std::vector<BadDraft> cases{
      {[](Draft& d) { d.warp_over.clear(); }, "empty"},
      {[](Draft& d) {
         d.warp_over = {{}, {}};
       },
       "empty"},
      {[](Draft& d) { d.warp_over[1].pop_back(); }, "ragged: pick 2 has 1 ends"},
      {[](Draft& d) {
         d.warp_over = {{true, true, false}, {true, false, true}};
       },
       "warp end 1 never interlaces: it lies over"},
      {[](Draft& d) {
         d.warp_over = {{true, false}, {false, true}, {true, true}};
       },
       "weft pick 3 never interlaces: it lies under"},
      {[](Draft& d) { d.warp_over = {{true}}; }, "never interlaces"},
      {[](Draft& d) { d.warp.diameter_mm = 0; }, "warp diameter is 0 mm"},
      {[](Draft& d) { d.weft.diameter_mm = -0.1; }, "weft diameter is -0.1 mm"},
      {[=](Draft& d) { d.weft.pitch_mm = nan; }, "weft pitch is nan mm"},
      {[](Draft& d) { d.warp.pitch_mm = 0.49; }, "warp pitch 0.49 mm is less than the yarn diameter 0.5 mm"},
      {[](Draft& d) { d.warp.threads.clear(); }, "warp has no threads"},
      {[](Draft& d) {
         d.weft.threads = {0, -1};
       },
       "weft thread -1"},
      {[](Draft& d) { d.height_scale = 0; }, "height scale is 0"},
      {[](Draft& d) { d.transverse_modulus_n_mm2 = -1; }, "transverse modulus is -1"},
      {[](Draft& d) { d.unevenness.radius = 0.3; }, "unevenness of the radius is 0.3"},
      {[=](Draft& d) { d.unevenness.pitch = nan; }, "unevenness of the pitch is nan"},
      {[](Draft& d) { d.unevenness.shades = 0; }, "number of shades of a thread is 0"},
      {[](Draft& d) { d.slubs.radius = -0.1; }, "slubs' deviation of the radius is -0.1"},
      {[](Draft& d) { d.slubs.twist = 0.5; }, "slubs' deviation of the twist is 0.5"},
      {[](Draft& d) { d.slubs.length_mm = 0; }, "slubs' length is 0"},
      {[](Draft& d) { d.slubs.shade_mm = -1; }, "length of a shade along a yarn is -1"},
      {[](Draft& d) { d.slubs.shade_mm = 3; }, "threads have one shade"},
      {[](Draft& d) { d.plies.count = 0; }, "number of plies of a yarn is 0"},
      {[](Draft& d) { d.plies.turns_per_mm = 1e9; }, "turns of the plies are 1e+09"},
      {[=](Draft& d) { d.plies.radius_mm = nan; }, "radius of a ply is nan"},
      {[](Draft& d) { d.warp.threads.assign(2049, 0); }, "too large: 4098 ends x 2 picks are 8196 crossings"},
      {[](Draft& d) { d.warp.threads.assign(5000, 0); }, "a repeat of 5000 yarns is too large"}};
  for (const BadDraft& bad : cases) {
    Draft draft = plain_draft();
    bad.spoil(draft);
    const std::string line = check_draft(draft).value_or("nothing found");
    EXPECT_NE(line.find(bad.named), std::string::npos) << "expected \"" << bad.named << "\", found: " << line;
    EXPECT_EQ(line.find('\n'), std::string::npos);
    EXPECT_THROW(initial_patch(draft), std::runtime_error) << bad.named;
  }
}

// Two plain cloths, one above the other: every yarn interlaces, and yet the upper half lifts off.
TEST(DraftTest, TwoPlainLayersThatNothingTiesTogetherAreRefused) {
  Draft draft = plain_draft();
  draft.warp_over.assign(4, std::vector<bool>(4));
  for (std::size_t pick = 0; pick < 4; ++pick) {
    for (std::size_t end = 0; end < 4; ++end) {
      const bool same_layer = pick % 2 == end % 2, upper_warp = end % 2 == 0;
      draft.warp_over[pick][end] = same_layer ? (pick / 2 + end / 2) % 2 == 0 : upper_warp;
    }
  }
  EXPECT_NE(check_draft(draft).value_or("").find("4 of the 8 yarns"), std::string::npos)
      << check_draft(draft).value_or("nothing");
  draft.warp_over[0][1] = true;  // one stitch ties the layers together
  EXPECT_FALSE(check_draft(draft));
}

TEST(DraftTest, TheLargestPatchIsWoven) {
  Draft draft = plain_draft();
  draft.warp.threads.assign(64, 0);
  draft.weft.threads.assign(64, 0);
  const YarnPatch patch = initial_patch(draft);
  EXPECT_EQ(patch.yarns.size(), 128u);
  EXPECT_NEAR(patch.least_gap_mm, initial_patch(plain_draft()).least_gap_mm, 1e-9);  // the same cloth, to rounding
}

}  // namespace
}  // namespace renderer

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>

#include "tests/renderer/weave/relaxed_cloths.h"

namespace renderer {
namespace {

void expect_same_measures(const YarnPatch& a, const YarnPatch& b, double tolerance) {
  std::printf("%-10s crimp %.8f %.8f against %.8f %.8f\n", a.name.c_str(), a.crimp_warp, a.crimp_weft, b.crimp_warp,
              b.crimp_weft);
  EXPECT_NEAR(a.crimp_warp, b.crimp_warp, tolerance) << a.name;
  EXPECT_NEAR(a.crimp_weft, b.crimp_weft, tolerance) << a.name;
  EXPECT_NEAR(a.thickness_mm, b.thickness_mm, tolerance) << a.name;
}

// The tolerance for the same points and samples at the same places. What differs is where Newton's method stops: a
// gradient of 1e-8 of the pull over the least stiffness of a cloth, some 1e-3 of pull / mm.
constexpr double kSame = 1e-6;

TEST(RelaxationTest, RepeatsOfThePatchChangeNothing) {
  for (const Draft& draft : uneven_drafts()) {
    Draft doubled = draft;
    doubled.warp.threads.assign(2 * draft.warp_over[0].size(), 0);
    doubled.weft.threads.assign(2 * draft.warp_over.size(), 0);
    expect_same_measures(relax(draft).patch, relax(doubled).patch, kSame);
  }
}

TEST(RelaxationTest, MovingOrTurningTheDraftMovesOrTurnsTheCloth) {
  for (const Draft& draft : uneven_drafts()) {
    Draft moved = draft;
    for (std::vector<bool>& pick : moved.warp_over) std::rotate(pick.begin(), pick.begin() + 1, pick.end());
    const YarnPatch cloth = relax(draft).patch;
    expect_same_measures(cloth, relax(moved).patch, kSame);
    YarnPatch back = relax(turned(draft)).patch;
    std::swap(back.crimp_warp, back.crimp_weft);
    expect_same_measures(cloth, back, kSame);
  }
}

TEST(RelaxationTest, EveryReadyWeaveOf24YarnsEachWayComesToRestAsDraftedWithLittleOverlap) {
  for (const Draft& draft : ready_weaves(24)) expect_woven(draft);
}

}  // namespace
}  // namespace renderer

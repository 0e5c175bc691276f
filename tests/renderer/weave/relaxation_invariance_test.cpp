#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>

#include "renderer/weave/relaxation.h"

namespace renderer {
namespace {

std::vector<Draft> uneven_drafts() {
  std::vector<Draft> drafts{twill_draft(2, 2), satin_draft(5, 2)};
  drafts[0].warp.pitch_mm = 0.65;
  drafts[0].weft.pitch_mm = 1.0;
  drafts[1].warp.pitch_mm = 0.55;
  drafts[1].weft = {.diameter_mm = 0.4, .pitch_mm = 1.1};
  return drafts;
}

void expect_same_measures(const YarnPatch& a, const YarnPatch& b, double tolerance) {
  std::printf("%-10s crimp %.8f %.8f against %.8f %.8f\n", a.name.c_str(), a.crimp_warp, a.crimp_weft, b.crimp_warp,
              b.crimp_weft);
  EXPECT_NEAR(a.crimp_warp, b.crimp_warp, tolerance) << a.name;
  EXPECT_NEAR(a.crimp_weft, b.crimp_weft, tolerance) << a.name;
  EXPECT_NEAR(a.thickness_mm, b.thickness_mm, tolerance) << a.name;
}

// 5e-4 (mm, or of a length): floats slide sideways at next to no cost, and 8 points per crossing see their neighbours'
// points where they stand (force balance below).
TEST(RelaxationTest, RepeatsOfThePatchChangeNothing) {
  for (const Draft& draft : uneven_drafts()) {
    Draft doubled = draft;
    doubled.warp.threads.assign(2 * draft.warp_over[0].size(), 0);
    doubled.weft.threads.assign(2 * draft.warp_over.size(), 0);
    expect_same_measures(relax(draft).patch, relax(doubled).patch, 5e-4);
  }
}

TEST(RelaxationTest, MovingOrTurningTheDraftMovesOrTurnsTheCloth) {
  for (const Draft& draft : uneven_drafts()) {
    Draft moved = draft;
    for (std::vector<bool>& pick : moved.warp_over) std::rotate(pick.begin(), pick.begin() + 1, pick.end());
    const YarnPatch cloth = relax(draft).patch;
    expect_same_measures(cloth, relax(moved).patch, 5e-4);
    Draft turned = draft;
    std::swap(turned.warp, turned.weft);
    const std::size_t picks = draft.warp_over.size(), ends = draft.warp_over[0].size();
    turned.warp_over.assign(ends, std::vector<bool>(picks));
    for (std::size_t pick = 0; pick < picks; ++pick)
      for (std::size_t end = 0; end < ends; ++end)
        turned.warp_over[end][picks - 1 - pick] = !draft.warp_over[pick][end];
    YarnPatch back = relax(turned).patch;
    std::swap(back.crimp_warp, back.crimp_weft);
    expect_same_measures(cloth, back, 5e-4);
  }
}

}  // namespace
}  // namespace renderer

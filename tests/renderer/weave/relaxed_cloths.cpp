#include "tests/renderer/weave/relaxed_cloths.h"

#include <gtest/gtest.h>

#include <cstdio>
#include <ctime>
#include <utility>

namespace renderer {

namespace {

Draft with_pitches(Draft draft, double warp_mm, double weft_mm) {
  draft.warp.pitch_mm = warp_mm;
  draft.weft.pitch_mm = weft_mm;
  return draft;
}

}  // namespace

Draft plain_cloth(double warp_pitch_mm, double weft_pitch_mm, double tension_n) {
  Draft draft = with_pitches(plain_draft(), warp_pitch_mm, weft_pitch_mm);
  draft.warp.tension_n = draft.weft.tension_n = tension_n;
  return draft;
}

std::vector<Draft> uneven_drafts() {
  std::vector<Draft> drafts{with_pitches(twill_draft(2, 2), 0.65, 1.0), satin_draft(5, 2)};
  drafts[1].warp.pitch_mm = 0.55;
  drafts[1].weft = {.diameter_mm = 0.4, .pitch_mm = 1.1};
  return drafts;
}

std::vector<Draft> ready_weaves(std::size_t yarns) {
  std::vector<Draft> drafts{with_pitches(plain_draft(), 0.9, 0.9),      with_pitches(twill_draft(2, 2), 0.65, 1.0),
                            with_pitches(twill_draft(3, 1), 0.6, 1.05), with_pitches(satin_draft(5, 2), 0.55, 1.1),
                            with_pitches(satin_draft(8, 3), 0.55, 1.1), with_pitches(basket_draft(2), 0.9, 0.9)};
  for (Draft& draft : drafts) {
    const std::size_t repeat = draft.warp_over.size();
    draft.warp.threads.assign((yarns + repeat - 1) / repeat * repeat, 0);
    draft.weft.threads = draft.warp.threads;
  }
  return drafts;
}

Draft turned(const Draft& draft) {
  Draft result = draft;
  std::swap(result.warp, result.weft);
  const std::size_t picks = draft.warp_over.size(), ends = draft.warp_over[0].size();
  result.warp_over.assign(ends, std::vector<bool>(picks));
  for (std::size_t pick = 0; pick < picks; ++pick)
    for (std::size_t end = 0; end < ends; ++end) result.warp_over[end][picks - 1 - pick] = !draft.warp_over[pick][end];
  return result;
}

void expect_woven(const Draft& draft) {
  const std::clock_t start = std::clock();
  const RelaxedPatch cloth = relax(draft);
  const double seconds = static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
  const RelaxationReport& r = cloth.report;
  std::printf(
      "%-12s %3zu yarns: %5.2f s of processor time, %d stages, %d Newton, gradient %.1e, overlap %.2f %%, gap %.2f "
      "%%, at crossings %.2f %%\n",
      draft.name.c_str(), cloth.patch.yarns.size(), seconds, r.stages, r.newton_steps, r.gradient, 100 * r.overlap,
      400 * cloth.patch.least_gap_mm, 100 * r.crown_gap);
  expect_at_rest(cloth);
  EXPECT_FALSE(r.jammed) << draft.name;
  EXPECT_GE(cloth.patch.least_gap_mm, -kMostOverlap * 0.25) << draft.name;
}

void expect_at_rest(const RelaxedPatch& relaxed) {
  const RelaxationReport& report = relaxed.report;
  EXPECT_TRUE(report.converged) << relaxed.patch.name;
  EXPECT_LT(report.gradient, 1e-6) << relaxed.patch.name;
  EXPECT_TRUE(report.as_drafted) << relaxed.patch.name;
}

}  // namespace renderer

#include "tests/renderer/weave/relaxed_cloths.h"

#include <gtest/gtest.h>

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

void expect_at_rest(const RelaxedPatch& relaxed) {
  const RelaxationReport& report = relaxed.report;
  EXPECT_TRUE(report.converged) << relaxed.patch.name;
  EXPECT_LT(report.gradient, 1e-6) << relaxed.patch.name;
  EXPECT_TRUE(report.as_drafted) << relaxed.patch.name;
}

}  // namespace renderer

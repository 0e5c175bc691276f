#include "station/session/record/bracket.h"

namespace station {

bool is_needed(const PlanStep& step, const std::map<std::string, PictureRecord>& taken) {
  if (step.kind != StepKind::bracket || !step.if_needed) return true;
  const auto view = taken.find(step.exposure_of);
  if (view == taken.end()) return true;  // not known yet
  const Finding* found = view->second.verdict.find(step.stops < 0 ? "saturation" : "shadows");
  if (found == nullptr || !found->value) return true;
  return step.stops < 0 ? *found->value > kSaturationNeedsShorter_percent : *found->value < kShadowsNeedLonger_percent;
}

}  // namespace station

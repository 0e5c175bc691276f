#pragma once

#include "station/documents/plan.h"

namespace station {

// A plan that runs quickly: a pose, three views of which two get the same exposure, and a dark for each.
inline Plan small_plan() {
  const Plan whole = make_capture_plan({});
  Plan plan;
  for (const char* id : {"pose-horizontal-1", "reflection-horizontal-1", "reflection-horizontal-2", "transmission-1",
                         "dark-reflection-horizontal-1", "dark-reflection-horizontal-2", "dark-transmission-1"}) {
    plan.steps.push_back(*find_step(whole, id));
    plan.steps.back().verify.clear();  // fakes show nothing
  }
  return plan;
}

}  // namespace station

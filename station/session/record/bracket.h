// The rule for which further exposures of a view are worth their time.
#pragma once

#include <map>
#include <string>

#include "station/documents/plan.h"
#include "station/session/record/picture_record.h"

namespace station {

// Whether a step has to be taken. False only for a bracket's exposure that is to be taken where the range needs it
// (PlanStep::if_needed) and whose view neither saturates anywhere, so that a shorter exposure would not help, nor is
// dark anywhere, so that a longer one would not. The answer comes from the verdicts in the journal alone, so that every
// run, verification and development give the same one.
bool is_needed(const PlanStep& step, const std::map<std::string, PictureRecord>& taken);

inline constexpr double kSaturationNeedsShorter_percent = 0.05;  // of the threads' window; hot pixels alone are fewer
inline constexpr double kShadowsNeedLonger_percent = 1;          // of the range; a tenth of the window lies below

}  // namespace station

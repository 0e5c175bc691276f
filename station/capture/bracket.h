// Which further exposures of a view are worth their time.
#pragma once

#include <map>
#include <string>

#include "station/capture/picture_record.h"
#include "station/capture/plan.h"

namespace station {

// False for a bracket's exposure that is to be taken only where the range needs it (PlanStep::if_needed) and whose view, as
// its verdict says, neither saturates anywhere (a shorter one would help) nor is dark anywhere (a longer one). Told by the
// journal alone, so that every run, verification and development agree.
bool is_needed(const PlanStep& step, const std::map<std::string, PictureRecord>& taken);

inline constexpr double kSaturationNeedsShorter_percent = 0.05;  // of the threads' window; single hot pixels are less
inline constexpr double kShadowsNeedLonger_percent = 1;  // of the range, what a tenth of the window stays below

}  // namespace station

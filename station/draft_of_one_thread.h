// A draft as it is woven of one digitized thread alone.
#pragma once

#include "renderer/weave/draft.h"

namespace station {

// Thread 0 in warp and weft, all lengths scaled so that the warp has this diameter; shades are left out.
renderer::Draft draft_of_one_thread(renderer::Draft draft, double diameter_mm);

}  // namespace station

// The draft of a cloth that is woven of one digitized thread alone.
#pragma once

#include "renderer/weave/draft.h"

namespace station {

// The draft with thread 0 in warp and weft and without shades, all its lengths scaled so that the warp yarn has this
// diameter.
renderer::Draft draft_of_one_thread(renderer::Draft draft, double diameter_mm);

}  // namespace station

// The initial patch: that of a draft before its yarns are relaxed.
#pragma once

#include "renderer/weave/draft.h"
#include "renderer/weave/patch.h"

namespace renderer {

// The patch of a draft with the analytic shapes of yarn_path.h, measured. Yarns are straight in plan: warp end j lies
// at x = (j + 1/2) pitch, weft pick i at y = (i + 1/2) pitch; control point 0 belongs to the knot on the cell's border.
// Errors: std::runtime_error with the line of check_draft().
YarnPatch initial_patch(const Draft& draft, int points_per_crossing = kPointsPerCrossing);

}  // namespace renderer

// The crossings of a patch: where each warp yarn meets each weft yarn in plan, and which lies on top there.
#pragma once

#include <vector>

#include "renderer/weave/patch.h"

namespace renderer {

struct Crossing {
  std::size_t warp = 0, weft = 0;       // indices into the patch's yarns
  double warp_z_mm = 0, weft_z_mm = 0;  // heights of the centre lines where they meet in plan
  double distance_mm = 0;         // between the tangents there: less than the heights tell where yarns are inclined
  double warp_t = 0, weft_t = 0;  // the yarns' spline parameters there
};

// The crossings of all pairs of a warp and a weft yarn, warp by warp.
std::vector<Crossing> crossings_of(const YarnPatch& patch);

// Whether at each crossing that yarn lies on top that the draft puts there, with the draft repeated as in
// initial_patch().
bool is_as_drafted(const YarnPatch& patch, const Draft& draft);

}  // namespace renderer

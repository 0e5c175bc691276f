// The check that must hold of every draft that was read, whatever file it came from.
#pragma once

#include <cstdlib>

#include "renderer/weave/initial_patch.h"
#include "renderer/weave/patch.h"
#include "station/documents/draft_file.h"

namespace station {

// Ends the program unless the draft can be written and read again and, when it is small, has a patch.
inline void expect_usable(const renderer::Draft& draft) {
  if (parse_draft(to_json(draft), "again").warp_over != draft.warp_over) std::abort();
  if (renderer::ends_in_patch(draft) * renderer::picks_in_patch(draft) <= 16) renderer::initial_patch(draft);
}

}  // namespace station

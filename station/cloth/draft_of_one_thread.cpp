#include "station/cloth/draft_of_one_thread.h"

namespace station {

renderer::Draft draft_of_one_thread(renderer::Draft draft, double diameter_mm) {
  const double scale = diameter_mm / draft.warp.diameter_mm;
  for (renderer::YarnSystem* system : {&draft.warp, &draft.weft}) {
    system->diameter_mm *= scale;
    system->pitch_mm *= scale;
    system->threads = {0};
  }
  draft.plies.radius_mm *= scale;
  draft.plies.turns_per_mm /= scale;
  draft.slubs.length_mm *= scale;
  draft.slubs.shade_mm = 0;
  draft.unevenness.shades = 1;
  return draft;
}

}  // namespace station

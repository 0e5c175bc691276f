// How bright a white card is in the light of a scene: what its pictures are exposed by.
#pragma once

#include <array>

#include "station/documents/scene_file.h"

namespace station {

// The radiance (camera RGB) that a card of albedo 1 sends along its normal in the light of the scene's lamps alone:
// neither cloth nor bodies shade it or reflect light on it.
std::array<double, 3> radiance_of_white_card(SceneFile scene, const WhiteCard& card);

}  // namespace station

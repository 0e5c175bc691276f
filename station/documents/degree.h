// One degree in radians, the renderer's, for the rooms of the station.
#pragma once

#include "renderer/scattering/degree.h"

namespace station {

using renderer::kDegree;

}  // namespace station

// The ranges of scattering parameters that documents and tables may give.
#pragma once

#include "station/documents/range.h"

namespace station {

inline constexpr Range kRefractiveIndex{1.01, 3}, kAbsorption{0, 1e4}, kRoughness{0.02, 1}, kTilt_deg{-45, 45};

}  // namespace station

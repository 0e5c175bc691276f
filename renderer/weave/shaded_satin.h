// Shaded satins: the weaves from weft-faced to warp-faced satin by which jacquard looms weave tones of two colours.
//
// Of every kSatinEnds crossings of a pick, the warp lies on top at `shade` ones side by side, and this group begins
// kSatinStep ends further on in each pick. Any mixture of shades is a cloth: every yarn interlaces in each of them.
#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "renderer/weave/draft.h"

namespace renderer {

inline constexpr int kSatinEnds = 8, kSatinStep = 3;
inline constexpr int kShades = kSatinEnds - 1;  // 1 (weft-faced) ... kShades (warp-faced)

// The structure (Draft::warp_over) of a picture of shades, whose first row is at the largest y. Errors:
// std::invalid_argument for a value that is no shade.
std::vector<std::vector<bool>> shaded_structure(const cv::Mat1b& shades);

}  // namespace renderer

// The drawing of a draft as weavers make it: one square per crossing of the patch, in the colour of the yarn that lies
// on top, the first pick at the bottom; the colour orders of warp and weft run along the edges.
#pragma once

#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "renderer/weave/draft.h"

namespace station {

// The colour (sRGB, red first) in which a thread is drawn, told apart at a glance; threads beyond the palette take it
// from the start again. The first two are the dark warp and light weft of textbooks, which the drawings take for the
// two systems when a draft has one thread only.
cv::Vec3b thread_color(int thread);
// Colours by thread instead of these, sRGB, taken from the start again where there are more threads; none: these.
using ThreadColours = std::vector<cv::Vec3b>;
cv::Vec3b thread_color(int thread, const ThreadColours& colours);
// The drawing as a picture and as SVG text.
cv::Mat3b draw_draft(const renderer::Draft& draft, const ThreadColours& colours = {}, int square_px = 16);
std::string draw_draft_svg(const renderer::Draft& draft, const ThreadColours& colours = {});

}  // namespace station

// A picture of a patch with plain shading: from above and in perspective, and below them cut along its first pick.
#pragma once

#include <filesystem>
#include <opencv2/core.hpp>

#include "renderer/weave/patch.h"

namespace station {

// Linear sRGB. Threads have the colours of draft_drawing.h; where all yarns are of one thread, the weft has the second. The
// light comes from the upper left, in front; yarns shade each other. The section has twice the width of cloth of the others.
cv::Mat3f draw_patch(const renderer::YarnPatch& patch, int panel_px = 480);

// By the ending: .exr (linear) or .png. Errors: std::runtime_error, one line.
void write_patch_view(const std::filesystem::path& file, const renderer::YarnPatch& patch);

}  // namespace station

// A picture of a patch with plain shading: from above and in perspective, and below them a section along its first
// pick.
#pragma once

#include <filesystem>
#include <opencv2/core.hpp>

#include "renderer/weave/patch.h"

namespace station {

// Draws the picture (linear sRGB). Threads have the colours of draft_drawing.h; where all yarns are of one thread, the
// weft takes the second colour. The light comes from the upper left, in front, and yarns shade each other. The section
// shows twice the width of cloth of the other two.
cv::Mat3f draw_patch(const renderer::YarnPatch& patch, int panel_px = 480);

// Writes the picture as .exr (linear) or .png, by the file's ending. Errors: std::runtime_error, one line.
void write_patch_picture(const std::filesystem::path& file, const renderer::YarnPatch& patch);

}  // namespace station

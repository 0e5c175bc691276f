// A picture of a patch with plain shading: from above and in perspective, and below them a section along its first
// pick.
#pragma once

#include <filesystem>
#include <opencv2/core.hpp>
#include <vector>

#include "renderer/weave/patch.h"
#include "station/documents/draft_drawing.h"

namespace station {

// Draws the picture (linear sRGB). Threads have `colours` or, without any, those of draft_drawing.h; where all yarns
// are of one thread, the weft takes the second colour. The light comes from the upper left, in front, and yarns shade
// each other. The section shows twice the width of cloth of the other two.
cv::Mat3f draw_patch(const renderer::YarnPatch& patch, const ThreadColours& colours = {}, int panel_px = 480);

// Writes the picture as .exr (linear) or .png, by the file's ending. Errors: std::runtime_error, one line.
void write_patch_picture(const std::filesystem::path& file, const renderer::YarnPatch& patch,
                         const ThreadColours& colours = {});

// The colours that digitized threads have for people, by what was photographed of them (thread_colour.h); of a bundle
// the albedo of its fibers' thread is not known, so that it has a colour of the drawings'.
ThreadColours colours_of_threads(const std::vector<std::filesystem::path>& files);

}  // namespace station

// The files of one developed view.
#pragma once

#include <array>
#include <filesystem>
#include <string>

#include "station/documents/views_file.h"

namespace station {

inline constexpr int kMaskSamples = 8;  // rays per pixel that decide what is thread (thread_mask)

// Where a view's picture and mask lie, relative to the session.
std::string image_file_of(const std::string& view);
std::string mask_file_of(const std::string& view);

// Writes the view's picture, whose values are `content`, its mask, and the mask's outline on the photograph
// (masks/<view>-overlay.png, at most 1200 pixels wide). Errors: those of image_file.h.
void write_view(const std::filesystem::path& session, const DevelopedView& developed, const std::string& content,
                const std::array<double, 9>& linear_srgb_from_camera);

}  // namespace station

// A picture of cloth (results.h) as a screen shows it.
#pragma once

#include <array>
#include <filesystem>
#include <opencv2/core.hpp>

namespace station {

// By the white card that its folder's made_of.json tells of, which stands in the place of the cloth, and `stops`
// brighter (display.h); where it tells of none, as before there were white cards, by the picture's own brightness.
// Errors: those of read_exr and reader.h.
cv::Mat3b shown_cloth(const std::filesystem::path& picture, int stops,
                      const std::array<double, 9>& linear_srgb_from_camera);

}  // namespace station

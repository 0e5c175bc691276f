// The simulated camera's live view: a small JPEG of what stands on the bench.
#pragma once

#include <opencv2/core.hpp>
#include <string>

namespace rig {

// The bytes of a JPEG file of `radiance` (linear RGB, any scale; the brightest becomes white).
std::string live_view_jpeg(const cv::Mat3f& radiance);

}  // namespace rig

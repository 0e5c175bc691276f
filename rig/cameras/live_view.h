// A small JPEG of what stands on the simulated bench, as a camera's display shows it.
#pragma once

#include <opencv2/core.hpp>
#include <string>

namespace rig {

// `radiance`: RGB, any scale; the brightest becomes white. Bytes of a JPEG file.
std::string live_view_jpeg(const cv::Mat3f& radiance);

}  // namespace rig

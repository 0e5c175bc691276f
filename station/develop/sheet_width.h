// The width of the sheet of threads on the holder, measured in a picture: turns x thread diameter.
#pragma once

#include <opencv2/core.hpp>
#include <optional>

#include "inversion/wrapped_spool.h"
#include "renderer/camera.h"

namespace station {

// `picture`: linear RGB; `camera` in the holder frame. Across the threads, averaged along them within the window, the
// brightness goes over from threads to black frame at the two edges, which are looked for within a fifth of the
// expected width. Good to about a tenth of a pixel, mm. std::nullopt when threads and frame are too much alike, or an
// edge is not in the picture.
std::optional<double> sheet_width_mm(const cv::Mat3f& picture, const renderer::Camera& camera,
                                     const inversion::WrappedSpool& spool);

}  // namespace station

// The width of the sheet of threads on the holder, measured in a picture: turns x thread diameter.
#pragma once

#include <opencv2/core.hpp>
#include <optional>

#include "inversion/view/wrapped_spool.h"
#include "renderer/picture/camera.h"

namespace station {

// Measures the width (mm) in a linear RGB picture; `camera` is in the holder's frame. Across the threads the
// brightness, averaged along them within the window, passes from threads to black frame at the two edges, which are
// searched for within a fifth of the expected width. The result is good to about a tenth of a pixel. Nothing is
// returned when threads and frame are too much alike, or an edge is not in the picture.
std::optional<double> sheet_width_mm(const cv::Mat3f& picture, const renderer::Camera& camera,
                                     const inversion::WrappedSpool& spool);

}  // namespace station

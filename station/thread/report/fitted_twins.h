// A developed view and its fitted twin, both inside the mask, for display at the same scale.
#pragma once

#include <filesystem>
#include <opencv2/core.hpp>
#include <string>

#include "inversion/view/view.h"

namespace station {

struct FittedTwins {
  cv::Mat3f photographed, fitted;  // linear camera RGB, radiance unit
  double scale = 1;                // display_scale() of the photograph (display.h), for both
  cv::Rect box;                    // the part with the threads
};

// Reads a view's twin by the fitted thread or a baseline (results.h); the view's own picture must have been read.
// Errors: those of read_exr, when the session was not fitted.
FittedTwins read_twins(const std::filesystem::path& session, const inversion::View& view,
                       const std::string& model = "thread");

// The residual, fitted minus photographed, averaged over the fit's blocks of `block_px`: grey (0.5 at the twins' scale)
// where it is zero.
cv::Mat3f residual_picture(const inversion::View& view, const FittedTwins& twins, int block_px);

}  // namespace station

// A developed view beside its fitted twin, both inside the mask and made ready to be displayed alike.
#pragma once

#include <filesystem>
#include <opencv2/core.hpp>

#include "inversion/view.h"

namespace station {

struct FittedTwins {
  cv::Mat3f photographed, fitted;  // linear camera RGB, radiance unit
  double scale = 1;                // display.h, of both
  cv::Rect box;                    // round the threads
};

// The view's picture must have been read. Errors: those of read_exr, where the session was not fitted.
FittedTwins read_twins(const std::filesystem::path& session, const inversion::View& view);

// Fitted minus photographed, averaged over the fit's blocks of `block_px`, round a middle grey at the twins' scale.
cv::Mat3f residual_picture(const inversion::View& view, const FittedTwins& twins, int block_px);

}  // namespace station

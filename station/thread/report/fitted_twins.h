// A developed view and its fitted twin, both inside the mask, for display at the same scale.
#pragma once

#include <filesystem>
#include <opencv2/core.hpp>
#include <optional>
#include <string>

#include "inversion/view/view.h"
#include "station/output/display.h"

namespace station {

struct FittedTwins {
  cv::Mat3f photographed, fitted;  // linear camera RGB, radiance unit
  Exposure exposure;               // of both
  cv::Rect box;                    // the part with the threads
};

// A white card in the spool's place that faces the light is white, and then so many stops brighter, or else as many as
// fit the threads. The view's picture must have been read.
Exposure exposure_of(const inversion::View& view, std::optional<int> stops = std::nullopt);

// Reads a view's twin by the fitted thread or a baseline (results.h); the view's own picture must have been read.
// `stops`: as above.
// Errors: those of read_exr, when the session was not fitted.
FittedTwins read_twins(const std::filesystem::path& session, const inversion::View& view,
                       const std::string& model = "thread", std::optional<int> stops = std::nullopt);

// The residual, fitted minus photographed, averaged over the fit's blocks of `block_px`: grey (half as bright as white)
// where it is zero.
cv::Mat3f residual_picture(const inversion::View& view, const FittedTwins& twins, int block_px);

}  // namespace station

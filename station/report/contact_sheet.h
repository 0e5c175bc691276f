// All developed views of a session in one picture, each with its mask's outline beside it.
#pragma once

#include <opencv2/core.hpp>

#include "station/documents/views_file.h"

namespace station {

// Three views (picture and outline) to a row, brightness of each view's own; sRGB. The views' pictures must have been read.
cv::Mat3b contact_sheet(const DevelopedViews& developed);

}  // namespace station

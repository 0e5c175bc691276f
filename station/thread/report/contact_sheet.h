// A contact sheet: all developed views of a session in one picture, each with its mask's outline beside it.
#pragma once

#include <opencv2/core.hpp>

#include "station/documents/views_file.h"

namespace station {

// The sheet (sRGB) with three views (picture and outline) to a row, each view at its own brightness. The views'
// pictures must have been read (read_view_pictures).
cv::Mat3b contact_sheet(const DevelopedViews& developed);

}  // namespace station

// Bilinear demosaicing of a linear mosaic, any number of rows at a time.
#pragma once

#include <array>
#include <opencv2/core.hpp>
#include <vector>

#include "calibration/develop.h"

namespace calibration {

// One raw value that a colour of a pixel is made from.
struct MosaicTap {
  int row = 0, column = 0;  // from the pixel
  float weight = 0;
};

// A normalised convolution: weights of the sites that a colour has in the 3 x 3 pixels around, over their sum. Inside
// the picture a linear ramp comes back exactly. A site of the colour itself has no other one in reach and keeps its own
// value. First index: 2 * (row % 2) + column % 2 of the pixel; second: colour. Empty for a colour that the mosaic
// lacks.
using MosaicTaps = std::array<std::array<std::vector<MosaicTap>, 3>, 4>;
MosaicTaps mosaic_taps(const std::array<int, 4>& channel);

// Fills these rows of `out`, whose pictures have the mosaic's size (variance: empty when the mosaic has none). Other
// rows may be filled at the same time. At the border the sites that exist are averaged.
void demosaic_rows(const LinearMosaic& raw, const cv::Range& rows, Developed& out);

}  // namespace calibration

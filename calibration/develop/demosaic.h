// Bilinear demosaicing of a linear mosaic, any number of rows at a time.
#pragma once

#include <array>
#include <opencv2/core.hpp>
#include <vector>

#include "calibration/develop/developed.h"
#include "calibration/develop/merge_exposures.h"

namespace calibration {

// One of the raw values from which a colour of a pixel is made.
struct MosaicTap {
  int row = 0, column = 0;  // offset from the pixel
  float weight = 0;
};

// The raw values that make each colour at each site of the 2 x 2 cell: the mean, with these weights over their sum, of
// the sites that have the colour within the 3 x 3 pixels around. It returns a linear ramp exactly inside the picture,
// and a pixel's own colour keeps its raw value. First index: 2 * (row % 2) + column % 2 of the pixel; second: colour.
// The list is empty for a colour that the mosaic lacks.
using MosaicTaps = std::array<std::array<std::vector<MosaicTap>, 3>, 4>;
MosaicTaps mosaic_taps(const std::array<int, 4>& channel);

// Fills these rows of `out`, whose pictures have the mosaic's size (the variance is empty when the mosaic has none).
// Other rows may be filled at the same time. At the picture's border only the sites that exist are averaged.
void demosaic_rows(const LinearMosaic& raw, const cv::Range& rows, Developed& out);

}  // namespace calibration

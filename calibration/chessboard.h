// A chessboard's inner corners in a picture.
#pragma once

#include <opencv2/core.hpp>
#include <optional>

#include "calibration/lattice.h"

namespace calibration {

// All `columns` x `rows` inner corners of a chessboard, or std::nullopt. `grey`: 8 bits, as displayed. A chessboard
// turned by half a turn looks the same, so which corner comes first is not known.
//
// OpenCV's findChessboardCorners, then cornerSubPix. On the 13 left photographs of Debian's opencv-doc (640 x 480, squares
// of 15-40 px) a window of 5 px leaves 0.133 px per axis and no outlier; 3 px 0.159; 11 px reaches the neighbouring
// corners (21 outliers); findChessboardCornersSB leaves 0.162 px and 8 outliers, and without an exhaustive search
// finds 11 of the 13.
std::optional<LatticeView> find_chessboard(const cv::Mat1b& grey, int columns, int rows);

}  // namespace calibration

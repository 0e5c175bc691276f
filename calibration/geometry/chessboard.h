// The search for a chessboard's inner corners in a picture.
#pragma once

#include <opencv2/core.hpp>
#include <optional>

#include "calibration/geometry/lattice.h"

namespace calibration {

// All `columns` x `rows` inner corners of a chessboard, or std::nullopt when they are not all found. `grey`: 8 bits, as
// displayed. A chessboard looks the same after half a turn, so it is not known which corner comes first.
//
// Method: OpenCV's findChessboardCorners, then cornerSubPix. On the 13 left photographs of Debian's opencv-doc (640 x
// 480, squares of 15-40 px) a window of 5 px leaves 0.133 px per axis and no outlier; 3 px leaves 0.159 px; 11 px
// reaches the neighbouring corners (21 outliers). findChessboardCornersSB leaves 0.162 px and 8 outliers, and finds
// only 11 of the 13 boards without an exhaustive search.
std::optional<BoardPicture> find_chessboard(const cv::Mat1b& grey, int columns, int rows);

}  // namespace calibration

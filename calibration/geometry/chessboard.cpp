#include "calibration/geometry/chessboard.h"

#include <algorithm>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>

namespace calibration {
namespace {

// How far refinement looks from a corner: 5 px on small pictures, an eighth of a square on large ones, and never so far
// that it reaches the next corner.
int window_px(const std::vector<cv::Point2f>& corners, int columns, int rows) {
  double shortest = 1e9;
  for (int row = 0; row < rows; ++row)
    for (int column = 0; column < columns; ++column) {
      const cv::Point2f& here = corners[static_cast<std::size_t>(row * columns + column)];
      if (column + 1 < columns)
        shortest = std::min(shortest, cv::norm(corners[static_cast<std::size_t>(row * columns + column + 1)] - here));
      if (row + 1 < rows)
        shortest = std::min(shortest, cv::norm(corners[static_cast<std::size_t>((row + 1) * columns + column)] - here));
    }
  const int wanted = std::max(5, static_cast<int>(shortest / 8.0));
  return std::max(2, std::min(wanted, static_cast<int>(0.45 * shortest)));
}

}  // namespace

std::optional<BoardPicture> find_chessboard(const cv::Mat1b& grey, int columns, int rows) {
  std::vector<cv::Point2f> corners;
  if (grey.empty() || !cv::findChessboardCorners(grey, {columns, rows}, corners,
                                                 cv::CALIB_CB_ADAPTIVE_THRESH | cv::CALIB_CB_NORMALIZE_IMAGE))
    return std::nullopt;
  const int window = window_px(corners, columns, rows);
  cv::cornerSubPix(grey, corners, {window, window}, {-1, -1},
                   cv::TermCriteria(cv::TermCriteria::COUNT | cv::TermCriteria::EPS, 100, 1e-4));
  BoardPicture picture;
  for (int row = 0; row < rows; ++row)  // OpenCV counts rows downwards
    for (int column = 0; column < columns; ++column) {
      const cv::Point2f& corner = corners[static_cast<std::size_t>(row * columns + column)];
      picture.push_back({column, rows - 1 - row, {corner.x, corner.y}});
    }
  // OpenCV may begin at any corner of a board whose two directions it cannot tell apart.
  const std::optional<BoardCheck> check = check_board(picture);
  if (check && check->mirrored)
    for (LatticeCorner& corner : picture) corner.column = columns - 1 - corner.column;
  return picture;
}

}  // namespace calibration

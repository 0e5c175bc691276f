// The refinement of a found tag's corners, which are moved onto the black square's edges in the linear picture.
//
// AprilTag 3.3 looks at whole pixels of an 8-bit picture: its corners are good to 0.06 px per axis on tags at odd
// angles but only to 0.15 px where edges run along rows and columns, and then all tags of a board err with the same
// sign. Here each edge is a straight line through positions interpolated in the linear picture, which gives 0.01-0.03
// px per axis in both cases. (cv::cornerSubPix looks for saddle points, which tags do not have, and makes corners
// worse.)
#pragma once

#include <Eigen/Core>
#include <array>
#include <opencv2/core.hpp>

namespace calibration {

// The refined corners of a tag in the linear picture `grey`. `corners_px`: the four corners in order, within about 1 px
// of the truth, centre of the first pixel at (0, 0); they are returned unchanged when the picture does not show the
// four edges well enough.
std::array<Eigen::Vector2d, 4> refined_corners(const cv::Mat1f& grey, const std::array<Eigen::Vector2d, 4>& corners_px);

}  // namespace calibration

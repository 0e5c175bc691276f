// The mask of the pixels that a polygon covers.
#pragma once

#include <Eigen/Core>
#include <array>
#include <opencv2/core.hpp>

namespace calibration {

// A mask with 255 inside the convex polygon and on its edge, 0 elsewhere. The corners (px, pixel centres at whole
// numbers) are rounded and may lie outside the picture.
cv::Mat1b polygon_mask(const cv::Size& size, const std::array<Eigen::Vector2d, 4>& corners_px);

}  // namespace calibration

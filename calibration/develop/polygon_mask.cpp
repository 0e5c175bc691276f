#include "calibration/develop/polygon_mask.h"

#include <opencv2/imgproc.hpp>

namespace calibration {

cv::Mat1b polygon_mask(const cv::Size& size, const std::array<Eigen::Vector2d, 4>& corners_px) {
  std::array<cv::Point, 4> outline;
  for (std::size_t i = 0; i < outline.size(); ++i)
    outline[i] = {cvRound(corners_px[i].x()), cvRound(corners_px[i].y())};
  cv::Mat1b mask(size, uchar{0});
  cv::fillConvexPoly(mask, outline.data(), static_cast<int>(outline.size()), cv::Scalar(255));
  return mask;
}

}  // namespace calibration

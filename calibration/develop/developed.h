// A developed picture: linear radiance with its noise.
#pragma once

#include <opencv2/core.hpp>

namespace calibration {

struct Developed {
  cv::Mat3f radiance;   // RGB; if undistorted: with the same intrinsic matrix, and 0 where the sensor did not see
  cv::Mat3f variance;   // of each pixel's radiance (neighbours are correlated); empty when the gain is not known
  cv::Mat1b saturated;  // 255 where any of the raw values that made the pixel is above 0.98 of the range
};

}  // namespace calibration

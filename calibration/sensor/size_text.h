// How messages name a picture's size: "6016 x 4016".
#pragma once

#include <opencv2/core/types.hpp>
#include <string>

namespace calibration {

inline std::string size_text(const cv::Size& size) {
  return std::to_string(size.width) + " x " + std::to_string(size.height);
}

}  // namespace calibration

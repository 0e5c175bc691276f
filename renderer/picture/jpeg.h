// JPEG pictures in memory, by libjpeg-turbo.
#pragma once

#include <opencv2/core.hpp>
#include <string>
#include <string_view>

namespace renderer {

std::string encode_jpeg(const cv::Mat3b& rgb, int quality_percent = 95);

enum class JpegDamage { refused, shown };  // of a file that breaks off or holds what it should not

// RGB, as stored: a rotation that EXIF asks for is not made. Errors: std::runtime_error with what is wrong in few
// words, also for inks (CMYK) instead of colours.
cv::Mat3b decode_jpeg(std::string_view bytes, JpegDamage damage = JpegDamage::refused);

}  // namespace renderer

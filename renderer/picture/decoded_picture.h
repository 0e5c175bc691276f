// What the readers of PNG, JPEG and TIFF files hand on: linear sRGB.
#pragma once

#include <filesystem>
#include <opencv2/core.hpp>
#include <string>

namespace renderer {

// Errors: std::runtime_error, one line, for more than kMostPicturePixels.
void check_size(const std::filesystem::path& file, double width, double height);

// Of display values; transparent parts become white.
cv::Mat3f linear_over_white(const cv::Mat4b& rgba);
cv::Mat3f linear_over_white(const cv::Mat4w& rgba);

// Of the bytes of `file`. Errors: std::runtime_error, one line.
cv::Mat3f linear_of_png(const std::string& bytes, const std::filesystem::path& file);
// 8 or 16 bits (sRGB) or floats (linear), grey or colour, as stored: neither turned nor mirrored.
cv::Mat3f linear_of_tiff(const std::filesystem::path& file);
// The same where 16 bits are linear too, up to 1; 8 bits, which cannot be, are refused.
cv::Mat3f light_of_tiff(const std::filesystem::path& file);

}  // namespace renderer

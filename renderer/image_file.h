// Pictures on disk through OpenImageIO: EXR (linear, float or half), PNG (8 bit) and TIFF. The only place that knows
// it.
//
// In memory a colour picture is cv::Mat3f, rows x columns x RGB (not BGR), linear.
#pragma once

#include <filesystem>
#include <map>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

namespace renderer {

using ImageHeader = std::map<std::string, std::string>;  // text attributes stored in the file

// Errors of all functions: std::runtime_error naming the file, what was found and what to do.

// Linear EXR, 3 x float; written to a temporary name, flushed and renamed.
void write_exr(const std::filesystem::path& file, const cv::Mat3f& linear, const ImageHeader& header = {});
cv::Mat3f read_exr(const std::filesystem::path& file, ImageHeader* header = nullptr);

// A named channel of an EXR file, "R" or "layer.R"; all of one file have the same size.
struct ExrChannel {
  std::string name;
  cv::Mat plane;      // one channel: float, or int for what is stored as unsigned 32 bit
  bool half = false;  // float stored in 16 bit, clipped at their largest number
};
void write_exr(const std::filesystem::path& file, const std::vector<ExrChannel>& channels,
               const ImageHeader& header = {});
std::vector<ExrChannel> read_exr_channels(const std::filesystem::path& file);

// A picture for people as linear sRGB: PNG and JPEG (sRGB-encoded; what is transparent is white) or EXR (linear already), of at
// most kMostPicturePixels; grey ones have three equal channels.
inline constexpr double kMostPicturePixels = 1e8;
cv::Mat3f read_linear_srgb(const std::filesystem::path& file);

// 8-bit PNG: a mask (grey), display colours (RGB, already encoded), or these with opacity that they are not multiplied by.
void write_png(const std::filesystem::path& file, const cv::Mat1b& grey);
void write_png(const std::filesystem::path& file, const cv::Mat3b& rgb);
void write_png(const std::filesystem::path& file, const cv::Mat4b& rgba);
cv::Mat1b read_png_grey(const std::filesystem::path& file);
// A PNG file's bytes, for embedding in a page.
std::string encode_png(const cv::Mat3b& rgb);

// linear * scale, through a 3 x 3 matrix, clipped and sRGB-encoded for display.
cv::Mat3b encode_srgb(const cv::Mat3f& linear, double scale,
                      const cv::Matx33f& linear_srgb_from_camera = cv::Matx33f::eye());
// A display colour (RGB) back to linear sRGB, 0 to 1.
cv::Vec3f linear_of_srgb(const cv::Vec3b& shown);

}  // namespace renderer

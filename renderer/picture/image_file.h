// Pictures on disk: EXR (linear, float or half) by OpenEXR, PNG (8 bit) by libpng; JPEG and TIFF are read.
//
// Not through OpenImageIO: Debian's loads 261 libraries, half a second of a processor at every start of a program.
//
// In memory a colour picture is cv::Mat3f, rows x columns x RGB (not BGR), linear.
#pragma once

#include <filesystem>
#include <map>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "renderer/picture/picture_bytes.h"

namespace renderer {

using ImageHeader = std::map<std::string, std::string>;  // text attributes stored in the file

// Errors of all functions: std::runtime_error naming the file, what was found and what to do.

enum class ExrCompression { zip, none };

// Writes or reads a linear EXR, 3 x float. It is written to a temporary name, flushed and renamed.
void write_exr(const std::filesystem::path& file, const cv::Mat3f& linear, const ImageHeader& header = {},
               ExrCompression compression = ExrCompression::zip);
cv::Mat3f read_exr(const std::filesystem::path& file, ImageHeader* header = nullptr);

// A named channel of an EXR file, "R" or "layer.R"; all of one file have the same size.
struct ExrChannel {
  std::string name;
  cv::Mat plane;      // one channel: float, or int for what is stored as unsigned 32 bit
  bool half = false;  // stored as 16-bit floats, clipped at the largest of these
};
void write_exr(const std::filesystem::path& file, const std::vector<ExrChannel>& channels,
               const ImageHeader& header = {}, ExrCompression compression = ExrCompression::zip);
std::vector<ExrChannel> read_exr_channels(const std::filesystem::path& file);

// Reads a picture made to be looked at as linear sRGB: PNG and JPEG (sRGB-encoded; transparent parts become white) or
// EXR (linear already), of at most kMostPicturePixels. Grey pictures get three equal channels.
cv::Mat3f read_linear_srgb(const std::filesystem::path& file);
// The same for a photograph, which may also be a TIFF file; as stored: neither turned nor mirrored.
cv::Mat3f read_photograph(const std::filesystem::path& file);
// Reads linear light as another program measured it: EXR, or TIFF with floats or with 16 linear bits (up to 1).
cv::Mat3f read_linear(const std::filesystem::path& file);

// Writes an 8-bit PNG: a mask (grey), display colours (RGB, already encoded), or display colours with an opacity by
// which they are not multiplied.
void write_png(const std::filesystem::path& file, const cv::Mat1b& grey);
void write_png(const std::filesystem::path& file, const cv::Mat3b& rgb);
void write_png(const std::filesystem::path& file, const cv::Mat4b& rgba);
cv::Mat1b read_png_grey(const std::filesystem::path& file);
// The bytes of a PNG file, for embedding in a page.
std::string encode_png(const cv::Mat3b& rgb);
// The colours of one. Errors: std::runtime_error.
cv::Mat3b decode_png(const std::string& bytes);

// The picture for display: linear * scale, through a 3 x 3 matrix, clipped and sRGB-encoded.
cv::Mat3b encode_srgb(const cv::Mat3f& linear, double scale,
                      const cv::Matx33f& linear_srgb_from_camera = cv::Matx33f::eye());
// The linear sRGB, 0 to 1, of a display colour (RGB).
cv::Vec3f linear_of_srgb(const cv::Vec3b& shown);

}  // namespace renderer

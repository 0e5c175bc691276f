// TIFF files by libtiff.
#include <tiffio.h>

#include <memory>
#include <optional>
#include <vector>

#include "renderer/picture/decoded_picture.h"
#include "renderer/picture/picture_bytes.h"
#include "renderer/picture/srgb.h"

namespace renderer {
namespace {

namespace fs = std::filesystem;
using Tiff = std::unique_ptr<TIFF, void (*)(TIFF*)>;
enum class Words { srgb, linear };  // what 16-bit values are

template <class Value>
Value field(TIFF* tiff, std::uint32_t tag, Value otherwise) {
  Value value = otherwise;
  return TIFFGetFieldDefaulted(tiff, tag, &value) ? value : otherwise;
}

// Rows of 16-bit or float values, grey or colour, one pixel's channels after the other; nothing for what libtiff only
// gives as 8 bits.
std::optional<cv::Mat3f> deep_pixels(TIFF* tiff, const fs::path& file, const cv::Size& size, Words encoded) {
  const auto bits = field<std::uint16_t>(tiff, TIFFTAG_BITSPERSAMPLE, 1),
             kind = field<std::uint16_t>(tiff, TIFFTAG_SAMPLEFORMAT, SAMPLEFORMAT_UINT),
             channels = field<std::uint16_t>(tiff, TIFFTAG_SAMPLESPERPIXEL, 1),
             colours = field<std::uint16_t>(tiff, TIFFTAG_PHOTOMETRIC, PHOTOMETRIC_MINISBLACK);
  const bool words = bits == 16 && kind == SAMPLEFORMAT_UINT, floats = bits == 32 && kind == SAMPLEFORMAT_IEEEFP;
  if (!words && !floats) return std::nullopt;
  const bool grey = colours == PHOTOMETRIC_MINISBLACK && (channels == 1 || channels == 2);
  const bool rows = !TIFFIsTiled(tiff) && field<std::uint16_t>(tiff, TIFFTAG_PLANARCONFIG, 1) == PLANARCONFIG_CONTIG;
  if (!rows || !(grey || (colours == PHOTOMETRIC_RGB && channels >= 3)))
    refuse_picture("reading picture " + file.string(), "it is a deep TIFF in tiles, planes or other colours",
                   "save it as PNG, or as an ordinary TIFF");
  cv::Mat3f linear(size);
  std::vector<unsigned char> line(static_cast<std::size_t>(TIFFScanlineSize(tiff)));
  const auto* as_words = reinterpret_cast<const std::uint16_t*>(line.data());
  const auto* as_floats = reinterpret_cast<const float*>(line.data());
  for (int row = 0; row < size.height; ++row) {
    if (TIFFReadScanline(tiff, line.data(), static_cast<std::uint32_t>(row)) != 1)
      refuse_damaged_picture(file, "it breaks off");
    for (int column = 0; column < size.width; ++column)
      for (int c = 0; c < 3; ++c) {
        const int at = column * channels + (grey ? 0 : c);
        const float word = words ? static_cast<float>(as_words[at]) / 65535 : 0;
        linear(row, column)[c] = !words ? as_floats[at] : encoded == Words::srgb ? srgb_decoded(word) : word;
      }
  }
  return linear;
}

Tiff opened(const fs::path& file) {
  TIFFSetWarningHandler(nullptr);  // they would go to standard error
  TIFFSetErrorHandler(nullptr);
  Tiff tiff(TIFFOpen(file.c_str(), "r"), TIFFClose);
  if (!tiff) refuse_damaged_picture(file, "it is no TIFF file");
  return tiff;
}

cv::Size size_of(TIFF* tiff, const fs::path& file) {
  const auto width = field<std::uint32_t>(tiff, TIFFTAG_IMAGEWIDTH, 0),
             height = field<std::uint32_t>(tiff, TIFFTAG_IMAGELENGTH, 0);
  check_size(file, width, height);
  return {static_cast<int>(width), static_cast<int>(height)};
}

}  // namespace

cv::Mat3f light_of_tiff(const fs::path& file) {
  const Tiff tiff = opened(file);
  if (const auto deep = deep_pixels(tiff.get(), file, size_of(tiff.get(), file), Words::linear)) return *deep;
  refuse_picture("reading picture " + file.string(), "it has 8 bits, which are too few for linear light",
                 "save it with 16 bits or as floats, without a gamma curve");
}

cv::Mat3f linear_of_tiff(const fs::path& file) {
  const Tiff tiff = opened(file);
  const cv::Size size = size_of(tiff.get(), file);
  if (const auto deep = deep_pixels(tiff.get(), file, size, Words::srgb)) return *deep;
  cv::Mat4b rgba(size);
  const int as_stored = field<std::uint16_t>(tiff.get(), TIFFTAG_ORIENTATION, ORIENTATION_TOPLEFT);
  if (TIFFReadRGBAImageOriented(tiff.get(), static_cast<std::uint32_t>(size.width),
                                static_cast<std::uint32_t>(size.height), reinterpret_cast<std::uint32_t*>(rgba.data),
                                as_stored, 1) != 1)
    refuse_damaged_picture(file, "it breaks off, or is of a kind that is not read");
  rgba.forEach([](cv::Vec4b& pixel, const int*) { pixel[3] = 255; });  // opacity is in the colours already
  return linear_over_white(rgba);
}

}  // namespace renderer

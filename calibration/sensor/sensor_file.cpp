#include "calibration/sensor/sensor_file.h"

#include <libraw/libraw.h>

#include <algorithm>
#include <array>
#include <ctime>
#include <fstream>
#include <memory>
#include <stdexcept>
#include <string_view>
#include <system_error>
#include <vector>

namespace calibration {
namespace {

[[noreturn]] void refuse(const std::string& name, const std::string& found, const std::string& what_to_do) {
  throw std::runtime_error("raw picture " + name + ": " + found + ": " + what_to_do);
}

void require(int status, const std::string& name, const std::string& step) {
  if (status == LIBRAW_SUCCESS) return;
  refuse(name, step + " failed with \"" + libraw_strerror(status) + "\"",
         "give a complete raw file as the camera wrote it");
}

// The date as the file has it: LibRaw takes it for local time and makes a time stamp of it, which is undone here.
std::string date_in_file(std::time_t stamp) {
  if (stamp <= 0) return {};
  std::tm parts{};
  localtime_r(&stamp, &parts);
  std::array<char, 32> text{};
  const std::size_t length = std::strftime(text.data(), text.size(), "%Y-%m-%dT%H:%M:%S", &parts);
  return {text.data(), length};
}

double black_level(const libraw_colordata_t& color) {
  double black = color.black;
  for (int c = 0; c < 4; ++c) black += color.cblack[c] / 4.0;
  const unsigned cells = color.cblack[4] * color.cblack[5];  // size of the repeating pattern that follows; 0: none
  for (unsigned i = 0; i < cells && 6 + i < LIBRAW_CBLACK_SIZE; ++i)
    black += color.cblack[6 + i] / static_cast<double>(cells);
  return black;
}

cv::Mat1w visible_mosaic(const LibRaw& raw) {
  const auto& sizes = raw.imgdata.rawdata.sizes;
  const cv::Mat1w all(sizes.raw_height, sizes.raw_width, raw.imgdata.rawdata.raw_image, sizes.raw_pitch);
  const cv::Rect visible(sizes.left_margin, sizes.top_margin, sizes.width, sizes.height);
  const cv::Mat1w seen = all(visible & cv::Rect(0, 0, all.cols, all.rows));
  cv::Mat1w mosaic(seen.size());
  cv::parallel_for_({0, seen.rows}, [&](const cv::Range& rows) { seen.rowRange(rows).copyTo(mosaic.rowRange(rows)); });
  return mosaic;
}

// Refuses files that have lost values. Sony's compressed ones (tag 259 = 32767, 8 bits a pixel) went through a tone
// curve to 11 bits and keep 16 pixels as two extremes and 7-bit steps between them, which makes the dark beside bright
// threads wrong. Nikon's lossy ones went through a curve, too, and its High Efficiency ones, which LibRaw 0.20 cannot
// read, through a wavelet transform; the maker note tells (tag 0x0093, by the numbers that ExifTool gives).
void refuse_lossy(LibRaw& raw, const std::string& name) {
  libraw_decoder_info_t decoder{};
  require(raw.get_decoder_info(&decoder), name, "looking for a decoder");
  if (decoder.decoder_flags & LIBRAW_DECODER_SONYARW2)
    refuse(name, "is a compressed RAW (11 bits, steps between neighbours)",
           "set the camera's RAW File Type to Uncompressed and take it again");
  constexpr std::array<unsigned, 4> kLossyNef{1, 4, 13, 14};  // lossy of two types, High Efficiency and its star
  if (std::ranges::find(kLossyNef, raw.imgdata.makernotes.nikon.NEFCompression) != kLossyNef.end())
    refuse(name, "is a NEF whose compression loses values",
           "set the camera's NEF (RAW) compression to Lossless compressed or Uncompressed and take it again");
}

// Refuses Canon's C-RAW, of which LibRaw 0.20 says nothing. Its mosaic of four planes is kept as wavelets, whose number
// of levels the header has ("CMP1", by the layout that LibRaw reads); there are none in a lossless CR3. Every CR2 with
// a mosaic is lossless.
void refuse_canon_lossy(std::span<const std::byte> bytes, const std::string& name) {
  constexpr std::string_view kBrand = "ftypcrx ", kHeader = "CMP1";
  constexpr std::size_t kBrandAt = 4, kPlanesAt = 29, kLevelsAt = 30;
  constexpr unsigned kMosaicPlanes = 4;
  const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  if (!text.substr(std::min(kBrandAt, text.size())).starts_with(kBrand)) return;
  for (std::size_t at = text.find(kHeader); at != std::string_view::npos && at + kLevelsAt < text.size();
       at = text.find(kHeader, at + 1)) {
    const auto byte = [&](std::size_t offset) { return std::to_integer<unsigned>(bytes[at + offset]); };
    if (byte(kPlanesAt) >> 4U == kMosaicPlanes && (byte(kLevelsAt) & 0xfU) > 0)
      refuse(name, "is a C-RAW, whose compression loses values",
             "set the camera's image quality to RAW and take it again");
    if (byte(kPlanesAt) >> 4U == kMosaicPlanes) return;  // what follows is pixels
  }
}

SensorPicture unpack(LibRaw& raw, const std::string& name) {
  refuse_lossy(raw, name);
  require(raw.unpack(), name, "unpacking");
  if (raw.imgdata.rawdata.raw_image == nullptr || raw.imgdata.idata.filters < 1000)
    refuse(name, "holds no 2 x 2 colour mosaic", "set the camera to RAW of full size, uncompressed or lossless");
  SensorPicture picture;
  picture.mosaic = visible_mosaic(raw);
  for (std::size_t i = 0; i < 4; ++i) {
    const int color = raw.COLOR(static_cast<int>(i / 2), static_cast<int>(i % 2));
    picture.channel[i] = color == 3 ? 1 : color;  // LibRaw gives the second green a number of its own
  }
  const auto& color = raw.imgdata.rawdata.color;
  picture.black_level_dn = black_level(color);
  picture.white_level_dn = color.maximum;
  if (!(picture.white_level_dn > picture.black_level_dn)) {
    refuse(name, "white level " + std::to_string(color.maximum) + " is not above the black level",
           "check the camera's raw format");
  }
  picture.exposure_s = raw.imgdata.other.shutter;
  picture.f_number = raw.imgdata.other.aperture;
  picture.iso = static_cast<int>(raw.imgdata.other.iso_speed + 0.5F);
  picture.focal_length_35mm = raw.imgdata.lens.FocalLengthIn35mmFormat;
  picture.make = raw.imgdata.idata.make;
  picture.model = raw.imgdata.idata.model;
  picture.serial = raw.imgdata.shootinginfo.BodySerial;
  picture.date_time = date_in_file(raw.imgdata.other.timestamp);
  return picture;
}

}  // namespace

SensorPicture read_sensor_bytes(std::span<const std::byte> bytes, const std::string& name_for_errors) {
  if (bytes.empty()) refuse(name_for_errors, "is empty", "take the picture again");
  refuse_canon_lossy(bytes, name_for_errors);
  const auto raw = std::make_unique<LibRaw>(LIBRAW_OPIONS_NO_DATAERR_CALLBACK);
  // LibRaw takes a non-const pointer and only reads from it.
  void* data = const_cast<std::byte*>(bytes.data());
  require(raw->open_buffer(data, bytes.size()), name_for_errors, "opening");
  return unpack(*raw, name_for_errors);
}

SensorPicture read_sensor_file(const std::filesystem::path& file) {
  std::error_code error;
  const std::uintmax_t size = std::filesystem::file_size(file, error);
  std::ifstream stream(file, std::ios::binary);
  if (error || !stream) refuse(file.string(), "cannot be read", "check the path and its permissions");
  std::vector<std::byte> bytes(size);
  stream.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(size));
  if (static_cast<std::uintmax_t>(stream.gcount()) != size)
    refuse(file.string(), "changed while it was read", "try again");
  return read_sensor_bytes(bytes, file.string());
}

}  // namespace calibration

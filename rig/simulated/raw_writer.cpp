#include "rig/simulated/raw_writer.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cctype>
#include <cmath>
#include <span>
#include <stdexcept>
#include <string_view>

namespace rig {
namespace {

static_assert(std::endian::native == std::endian::little, "the file is written in the order of the machine");

enum FieldType : std::uint16_t { kByte = 1, kAscii = 2, kShort = 3, kLong = 4, kRational = 5, kSignedShort = 8 };

struct Field {
  std::uint16_t tag, type;
  std::uint32_t count;
  std::vector<std::byte> data;
};
using Directory = std::vector<Field>;

template <typename T>
void append(std::vector<std::byte>& bytes, T value) {
  for (const std::byte byte : std::bit_cast<std::array<std::byte, sizeof(T)>>(value)) bytes.push_back(byte);
}

// `count` where it is not the number of `values`: fractions have two.
template <typename T>
Field numbers(std::uint16_t tag, FieldType type, const std::vector<T>& values, std::size_t count = 0) {
  Field field{tag, type, static_cast<std::uint32_t>(count == 0 ? values.size() : count), {}};
  for (const T value : values) append(field.data, value);
  return field;
}

Field short_number(std::uint16_t tag, std::uint16_t value) {
  return numbers<std::uint16_t>(tag, kShort, {value});
}
Field long_number(std::uint16_t tag, std::uint32_t value) {
  return numbers<std::uint32_t>(tag, kLong, {value});
}

Field text(std::uint16_t tag, std::string_view value) {
  Field field{tag, kAscii, static_cast<std::uint32_t>(value.size() + 1), {}};
  for (const char c : value) append(field.data, c);
  append(field.data, '\0');
  return field;
}

// A number as the fraction that cameras write (1/250, 13/10): a unit fraction where the reciprocal is whole, millionths
// at worst.
Field rational(std::uint16_t tag, double value) {
  if (value == 0) return numbers<std::uint32_t>(tag, kRational, {0, 1}, 1);
  std::uint32_t numerator = 1, denominator = 1;
  if (const double reciprocal = std::round(1 / value); reciprocal >= 2 && std::abs(reciprocal * value - 1) < 1e-9) {
    denominator = static_cast<std::uint32_t>(reciprocal);
  } else {
    while (denominator < 1'000'000 && std::abs(std::round(value * denominator) / denominator - value) > 1e-9 * value)
      denominator *= 10;
    numerator = static_cast<std::uint32_t>(std::lround(value * denominator));
  }
  return numbers<std::uint32_t>(tag, kRational, {numerator, denominator}, 1);
}

std::size_t padded(std::size_t size) {
  return (size + 1) & ~std::size_t{1};
}

std::size_t directory_size(const Directory& directory) {
  std::size_t size = 2 + 12 * directory.size() + 4;
  for (const Field& field : directory) size += field.data.size() > 4 ? padded(field.data.size()) : 0;
  return size;
}

// Appends entries sorted by tag, then the values that do not fit into an entry.
void append_directory(std::vector<std::byte>& file, Directory directory) {
  std::ranges::sort(directory, {}, &Field::tag);
  std::vector<std::byte> values;
  const std::size_t values_at = file.size() + 2 + 12 * directory.size() + 4;
  append(file, static_cast<std::uint16_t>(directory.size()));
  for (const Field& field : directory) {
    append(file, field.tag);
    append(file, field.type);
    append(file, field.count);
    if (field.data.size() > 4) {
      append(file, static_cast<std::uint32_t>(values_at + values.size()));
      values.insert(values.end(), field.data.begin(), field.data.end());
      values.resize(padded(values.size()));
    } else {
      file.insert(file.end(), field.data.begin(), field.data.end());
      file.resize(file.size() + 4 - field.data.size());
    }
  }
  append(file, std::uint32_t{0});  // no next directory
  file.insert(file.end(), values.begin(), values.end());
}

// The EXIF date ("2026:11:21 10:20:30") of an ISO 8601 one ("2026-11-21T10:20:30.123Z").
std::string exif_date(const std::string& utc) {
  constexpr std::string_view kPattern = "dddd-dd-ddTdd:dd:dd";
  const auto fits = [](char wanted, char found) {
    return wanted == 'd' ? std::isdigit(static_cast<unsigned char>(found)) != 0 : wanted == found;
  };
  if (utc.size() < kPattern.size() || !std::equal(kPattern.begin(), kPattern.end(), utc.begin(), fits))
    throw std::runtime_error("a raw file was to be dated \"" + utc + "\", which is not an ISO 8601 date and time");
  std::string date = utc.substr(0, kPattern.size());
  date[4] = date[7] = ':';
  date[10] = ' ';
  return date;
}

void check(const RawFrame& frame) {
  if (frame.mosaic.empty()) throw std::runtime_error("a raw file was to be written from a mosaic without pixels");
  const std::uint16_t highest = *std::max_element(frame.mosaic.begin(), frame.mosaic.end());
  if (std::max(highest, frame.black_level_dn) > kRawWhiteLevelDn) {
    throw std::runtime_error("a raw file was to be written with values up to " + std::to_string(highest) +
                             " and black level " + std::to_string(frame.black_level_dn) +
                             "; it has 14 bits, up to 16383");
  }
  const CameraSettings& settings = frame.settings;
  const auto positive = [](double value) { return std::isfinite(value) && value > 0; };
  if (!positive(settings.exposure_s) || !(settings.f_number == 0 || positive(settings.f_number)) || settings.iso <= 0 ||
      settings.iso > 65535) {
    throw std::runtime_error("a raw file was to be written with exposure " + std::to_string(settings.exposure_s) +
                             " s, f/" + std::to_string(settings.f_number) + ", ISO " + std::to_string(settings.iso) +
                             "; all must be positive, ISO at most 65535");
  }
}

Directory exif_directory(const RawFrame& frame) {
  Directory exif{rational(0x829a, frame.settings.exposure_s), rational(0x829d, frame.settings.f_number),
                 short_number(0x8827, static_cast<std::uint16_t>(frame.settings.iso)),
                 text(0x9003, exif_date(frame.utc)), text(0xa431, frame.serial)};
  if (frame.focal_length_mm > 0) {
    exif.push_back(rational(0x920a, frame.focal_length_mm));
    exif.push_back(short_number(0xa405, static_cast<std::uint16_t>(std::lround(frame.focal_length_mm))));
  }
  return exif;
}

Directory sony_levels(const RawFrame& frame) {
  const std::uint16_t black = frame.black_level_dn, white = kRawWhiteLevelDn;
  return {numbers<std::uint16_t>(0x7310, kShort, {black, black, black, black}),
          numbers<std::int16_t>(0x7313, kSignedShort, {1024, 1024, 1024, 1024}),  // white balance: factors of 1
          numbers<std::uint16_t>(0x787f, kShort, {white, white, white})};
}

Directory dng_levels(const RawFrame& frame) {
  return {numbers<std::uint8_t>(50710, kByte, {0, 1, 2}),  // the colours of the filter array: red, green, blue
          short_number(50711, 1),                          // on a rectangular grid
          short_number(50714, frame.black_level_dn), short_number(50717, kRawWhiteLevelDn)};
}

Directory mosaic_directory(const RawFrame& frame, std::uint32_t pixels_at) {
  const auto width = static_cast<std::uint32_t>(frame.mosaic.cols);
  const auto height = static_cast<std::uint32_t>(frame.mosaic.rows);
  Directory directory{long_number(254, 0),  // full resolution
                      long_number(256, width),
                      long_number(257, height),
                      short_number(258, 16),
                      short_number(259, 1),      // not compressed
                      short_number(262, 32803),  // colour filter array
                      long_number(273, pixels_at),
                      short_number(277, 1),
                      long_number(278, height),
                      long_number(279, width * height * 2),
                      numbers<std::uint16_t>(0x828d, kShort, {2, 2}),
                      numbers<std::uint8_t>(0x828e, kByte, {0, 1, 1, 2})};  // RGGB
  const Directory levels = frame.make == CameraMake::sony ? sony_levels(frame) : dng_levels(frame);
  directory.insert(directory.end(), levels.begin(), levels.end());
  return directory;
}

Directory main_directory(const RawFrame& frame, std::size_t mosaic_at, std::size_t exif_at) {
  const RawNames names = raw_names(frame.make);
  Directory directory{text(271, names.make),
                      text(272, names.model),
                      short_number(274, 1),
                      text(306, exif_date(frame.utc)),
                      long_number(330, static_cast<std::uint32_t>(mosaic_at)),
                      long_number(0x8769, static_cast<std::uint32_t>(exif_at))};
  if (frame.make != CameraMake::sony) {
    directory.push_back(numbers<std::uint8_t>(50706, kByte, {1, 4, 0, 0}));  // DNG 1.4
    directory.push_back(text(50708, names.model));
    directory.push_back(
        numbers<std::uint32_t>(50728, kRational, {1, 1, 1, 1, 1, 1}, 3));  // white balance: factors of 1
  }
  return directory;
}

}  // namespace

std::vector<std::byte> encode_raw(const RawFrame& frame) {
  check(frame);
  const Directory exif = exif_directory(frame);
  const std::size_t mosaic_at = 8 + directory_size(main_directory(frame, 0, 0));
  const std::size_t exif_at = mosaic_at + directory_size(mosaic_directory(frame, 0));
  const std::size_t pixels_at = exif_at + directory_size(exif);

  std::vector<std::byte> file;
  file.reserve(pixels_at + frame.mosaic.total() * 2);
  append(file, std::array<char, 4>{'I', 'I', 42, 0});
  append(file, std::uint32_t{8});
  append_directory(file, main_directory(frame, mosaic_at, exif_at));
  append_directory(file, mosaic_directory(frame, static_cast<std::uint32_t>(pixels_at)));
  append_directory(file, exif);
  for (int row = 0; row < frame.mosaic.rows; ++row) {
    const auto pixels = std::as_bytes(std::span(frame.mosaic[row], static_cast<std::size_t>(frame.mosaic.cols)));
    file.insert(file.end(), pixels.begin(), pixels.end());
  }
  return file;
}

}  // namespace rig

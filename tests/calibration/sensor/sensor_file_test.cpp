// Raw files here are made by rig's writer of the simulated camera's files: what it was given is the truth.
#include "calibration/sensor/sensor_file.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <string_view>
#include <utility>

#include "rig/simulated/raw_writer.h"

namespace calibration {
namespace {

rig::RawFrame frame() {
  rig::RawFrame frame{.mosaic = cv::Mat1w(80, 120),
                      .settings = {.exposure_s = 0.25, .iso = 200, .f_number = 5.6},
                      .utc = "2026-11-21T10:20:30.000Z",
                      .serial = "SIM0042"};
  for (int row = 0; row < 80; ++row)
    for (int column = 0; column < 120; ++column)
      frame.mosaic(row, column) = static_cast<ushort>((row * 7919 + column * 523) % 16384);
  return frame;
}

std::string error_of(std::span<const std::byte> bytes) {
  try {
    read_sensor_bytes(bytes, "shot.arw");
  } catch (const std::runtime_error& error) {
    return error.what();
  }
  return "";
}

// The bytes of a number, the lowest first.
std::vector<std::byte> little_endian(std::uint64_t value, int count) {
  std::vector<std::byte> out;
  for (int i = 0; i < count; ++i) out.push_back(static_cast<std::byte>(value >> (8 * i)));
  return out;
}

TEST(SensorFile, TheMosaicComesBackAsItWasRecordedBlackLevelIncluded) {
  const rig::RawFrame written = frame();
  const SensorPicture read = read_sensor_bytes(rig::encode_raw(written), "shot.arw");
  ASSERT_EQ(read.mosaic.size(), written.mosaic.size());
  EXPECT_EQ(cv::countNonZero(read.mosaic != written.mosaic), 0);
}

TEST(SensorFile, LevelsColoursExposureAndIdentityAreTheFiles) {
  const SensorPicture read = read_sensor_bytes(rig::encode_raw(frame()), "shot.arw");
  EXPECT_EQ(read.channel, (std::array<int, 4>{0, 1, 1, 2}));
  EXPECT_DOUBLE_EQ(read.black_level_dn, 512);
  EXPECT_DOUBLE_EQ(read.white_level_dn, 16383);
  EXPECT_NEAR(read.exposure_s, 0.25, 1e-6);  // single precision in the reader
  EXPECT_NEAR(read.f_number, 5.6, 1e-5);
  EXPECT_EQ(read.iso, 200);
  EXPECT_EQ(read.make, "Sony");
  EXPECT_EQ(read.model, "ILCE-7M2");
  EXPECT_EQ(read.serial, "SIM0042");
  EXPECT_EQ(read.date_time, "2026-11-21T10:20:30");
}

TEST(SensorFile, AFileOnDiskReadsLikeItsBytes) {
  const auto bytes = rig::encode_raw(frame());
  const std::filesystem::path file = std::filesystem::path(testing::TempDir()) / "threadstation_sensor_file_test.arw";
  std::ofstream(file, std::ios::binary)
      .write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  const SensorPicture read = read_sensor_file(file);
  EXPECT_EQ(cv::countNonZero(read.mosaic != frame().mosaic), 0);
  std::filesystem::remove(file);
  EXPECT_THROW(read_sensor_file(file), std::runtime_error);
}

TEST(SensorFile, AFileCutShortAnywhereGivesOneLineThatNamesIt) {
  const auto bytes = rig::encode_raw(frame());
  for (std::size_t left : {std::size_t{0}, std::size_t{1}, std::size_t{7}, std::size_t{100}, std::size_t{400},
                           bytes.size() / 2, bytes.size() - 2}) {
    const std::string error = error_of(std::span(bytes).first(left));
    EXPECT_NE(error.find("shot.arw"), std::string::npos) << left << " bytes of " << bytes.size() << " were accepted";
    EXPECT_EQ(error.find('\n'), std::string::npos);
  }
}

TEST(SensorFile, AFileThatIsNoRawPictureGivesOneLineThatNamesIt) {
  std::vector<std::byte> text(5000, std::byte{'a'});
  EXPECT_NE(error_of(text).find("shot.arw"), std::string::npos);
  EXPECT_NE(error_of(std::vector<std::byte>(5000, std::byte{0})).find("shot.arw"), std::string::npos);
}

// The camera's compressed file of the same size: two entries of the mosaic's directory say so.
TEST(SensorFile, ACompressedFileIsRefusedWithTheMenuToChange) {
  std::vector<std::byte> bytes = rig::encode_raw(frame());
  const auto set_entry = [&](std::uint16_t tag, std::uint16_t type, std::uint32_t from, std::uint32_t to) {
    std::vector<std::byte> entry = little_endian(tag, 2);
    for (const auto& part : {little_endian(type, 2), little_endian(1, 4), little_endian(from, 4)})
      entry.insert(entry.end(), part.begin(), part.end());
    const auto found = std::search(bytes.begin(), bytes.end(), entry.begin(), entry.end());
    ASSERT_NE(found, bytes.end()) << "tag " << tag;
    const std::vector<std::byte> value = little_endian(to, 4);
    std::copy(value.begin(), value.end(), found + 8);
  };
  set_entry(259, 3, 1, 32767);
  set_entry(279, 4, 120 * 80 * 2, 120 * 80);
  const std::string error = error_of(bytes);
  EXPECT_NE(error.find("shot.arw"), std::string::npos) << error;
  EXPECT_NE(error.find("compressed"), std::string::npos) << error;
  EXPECT_NE(error.find("Uncompressed"), std::string::npos) << error;
}

// A Nikon file whose maker note says how it is compressed. The note takes the place of the EXIF serial number.
std::vector<std::byte> nikon_file(unsigned compression) {
  constexpr std::uint16_t kSerial = 0xa431, kMakerNote = 0x927c, kUndefined = 7, kShort = 3;
  rig::RawFrame written = frame();
  written.make = rig::CameraMake::nikon;
  std::vector<std::byte> note;
  const auto append = [&](std::uint64_t value, int count) {
    for (const std::byte byte : little_endian(value, count)) note.push_back(byte);
  };
  for (const char c : std::string_view("Nikon\0\2\x10\0\0", 10)) note.push_back(static_cast<std::byte>(c));
  append(0x4949, 2);  // a directory of its own, with this one entry
  append(42, 2);
  append(8, 4);
  append(1, 2);
  append(0x0093, 2);
  append(kShort, 2);
  append(1, 4);
  append(compression, 4);
  append(0, 4);
  written.serial = std::string(note.size() - 1, 'S');  // and its end
  std::vector<std::byte> bytes = rig::encode_raw(written);
  const std::vector<std::byte> tag = little_endian(kSerial, 2), letter(8, std::byte{'S'});
  const auto entry = std::search(bytes.begin(), bytes.end(), tag.begin(), tag.end());
  const auto value = std::search(bytes.begin(), bytes.end(), letter.begin(), letter.end());
  EXPECT_TRUE(entry != bytes.end() && value != bytes.end());
  std::ranges::copy(note, value);
  std::ranges::copy(little_endian(kMakerNote, 2), entry);
  std::ranges::copy(little_endian(kUndefined, 2), entry + 2);
  return bytes;
}

TEST(SensorFile, ANikonFileThatHasLostValuesIsRefusedWithTheMenuToChangeAndALosslessOneIsRead) {
  for (const unsigned lossy : {1U, 4U, 13U, 14U})
    EXPECT_NE(error_of(nikon_file(lossy)).find("compression to Lossless compressed or Uncompressed"), std::string::npos)
        << lossy << error_of(nikon_file(lossy));
  for (const unsigned lossless : {2U, 3U, 6U}) EXPECT_EQ(error_of(nikon_file(lossless)), "") << lossless;
}

// The headers of a CR3, without its pixels: that of a preview of three planes, then that of the mosaic.
std::vector<std::byte> canon_file(int wavelet_levels) {
  std::vector<std::byte> bytes;
  const auto append = [&](const std::string& text) {
    for (const char c : text) bytes.push_back(static_cast<std::byte>(c));
  };
  append(std::string("\0\0\0\x18", 4) + "ftypcrx ");
  for (const auto& [planes, levels] : std::vector<std::pair<int, int>>{{3, 1}, {4, wavelet_levels}}) {
    append(std::string("\0\0\0\x3c", 4) + "CMP1" + std::string(25, '\0'));
    append({static_cast<char>(planes << 4), static_cast<char>(levels)});
    append(std::string(25, '\0'));
  }
  return bytes;
}

TEST(SensorFile, ACanonFileOfWaveletsIsRefusedWithTheMenuToChange) {
  EXPECT_NE(error_of(canon_file(3)).find("is a C-RAW, whose compression loses values: set the camera's image quality"),
            std::string::npos)
      << error_of(canon_file(3));
  EXPECT_EQ(error_of(canon_file(0)).find("C-RAW"), std::string::npos);
}

}  // namespace
}  // namespace calibration

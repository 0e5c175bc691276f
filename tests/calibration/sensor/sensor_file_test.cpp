// Raw files here are made by rig's writer of the simulated camera's files: what it was given is the truth.
#include "calibration/sensor/sensor_file.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>

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
    const auto number = [&](std::uint64_t value, int count) {
      std::vector<std::byte> out;
      for (int i = 0; i < count; ++i) out.push_back(static_cast<std::byte>(value >> (8 * i)));
      return out;
    };
    std::vector<std::byte> entry = number(tag, 2);
    for (const auto& part : {number(type, 2), number(1, 4), number(from, 4)})
      entry.insert(entry.end(), part.begin(), part.end());
    const auto found = std::search(bytes.begin(), bytes.end(), entry.begin(), entry.end());
    ASSERT_NE(found, bytes.end()) << "tag " << tag;
    const std::vector<std::byte> value = number(to, 4);
    std::copy(value.begin(), value.end(), found + 8);
  };
  set_entry(259, 3, 1, 32767);
  set_entry(279, 4, 120 * 80 * 2, 120 * 80);
  const std::string error = error_of(bytes);
  EXPECT_NE(error.find("shot.arw"), std::string::npos) << error;
  EXPECT_NE(error.find("compressed"), std::string::npos) << error;
  EXPECT_NE(error.find("Uncompressed"), std::string::npos) << error;
}

}  // namespace
}  // namespace calibration

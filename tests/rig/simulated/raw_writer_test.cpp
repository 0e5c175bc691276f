#include "rig/simulated/raw_writer.h"

#include <gtest/gtest.h>

#include <ctime>
#include <random>

#include "tests/rig/simulated/raw_reader.h"

namespace {

rig::RawFrame random_frame(int rows, int columns) {
  rig::RawFrame frame;
  frame.mosaic.create(rows, columns);
  std::mt19937 random(5);
  for (auto& pixel : frame.mosaic) pixel = static_cast<std::uint16_t>(random() % 16384);
  frame.settings = {.exposure_s = 0.25, .iso = 400, .f_number = 5.6};
  frame.utc = "2026-11-21T10:20:30.123Z";
  frame.serial = "SIM17";
  return frame;
}

}  // namespace

TEST(RawWriter, AnIndependentReaderFindsEveryPixelAndLevel) {
  for (const cv::Size size : {cv::Size(600, 400), cv::Size(64, 48), cv::Size(301, 203)}) {
    const rig::RawFrame frame = random_frame(size.height, size.width);
    const ReadRaw raw = read_raw(rig::encode_raw(frame));
    ASSERT_EQ(raw.mosaic.size(), size);
    EXPECT_EQ(cv::norm(raw.mosaic, frame.mosaic, cv::NORM_INF), 0);
    EXPECT_EQ(raw.black_dn, 512);
    EXPECT_EQ(raw.maximum_dn, 16383);
    EXPECT_EQ(raw.filters, "RGGB");
  }
}

TEST(RawWriter, AnIndependentReaderFindsTheCameraAndItsSettings) {
  const ReadRaw raw = read_raw(rig::encode_raw(random_frame(40, 60)));
  EXPECT_EQ(raw.make, "Sony");
  EXPECT_EQ(raw.model, "ILCE-7M2");
  EXPECT_EQ(raw.serial, "SIM17");
  EXPECT_EQ(raw.iso, 400);
  EXPECT_FLOAT_EQ(static_cast<float>(raw.f_number), 5.6F);
  std::tm date{};
  date.tm_year = 126, date.tm_mon = 10, date.tm_mday = 21, date.tm_hour = 10, date.tm_min = 20, date.tm_sec = 30;
  date.tm_isdst = -1;
  EXPECT_EQ(raw.unix_s, static_cast<long>(std::mktime(&date)));
}

TEST(RawWriter, AnotherBlackLevelComesBackToo) {
  rig::RawFrame frame = random_frame(40, 60);
  frame.black_level_dn = 128;
  EXPECT_EQ(read_raw(rig::encode_raw(frame)).black_dn, 128);
}

TEST(RawWriter, EngravedExposureTimesComeBack) {
  rig::RawFrame frame = random_frame(40, 60);
  for (const double exposure_s : {1 / 4000.0, 1 / 13.0, 1 / 3.0, 0.4, 0.8, 1.0, 1.3, 2.5, 30.0}) {
    frame.settings.exposure_s = exposure_s;
    // LibRaw keeps single precision.
    EXPECT_FLOAT_EQ(static_cast<float>(read_raw(rig::encode_raw(frame)).exposure_s), static_cast<float>(exposure_s));
  }
}

TEST(RawWriter, RefusesWhatNoReaderCouldUse) {
  rig::RawFrame frame = random_frame(40, 60);
  frame.utc = "yesterday";
  EXPECT_THROW(rig::encode_raw(frame), std::runtime_error);
  frame = random_frame(40, 60);
  frame.settings.exposure_s = 0;
  EXPECT_THROW(rig::encode_raw(frame), std::runtime_error);
  frame = random_frame(40, 60);
  frame.mosaic(3, 4) = 16384;
  EXPECT_THROW(rig::encode_raw(frame), std::runtime_error);
  frame.mosaic = cv::Mat1w();
  EXPECT_THROW(rig::encode_raw(frame), std::runtime_error);
}

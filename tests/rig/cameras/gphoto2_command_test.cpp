// Debian's own gphoto2 command against the simulated camera: what it says and what it downloads.
#include "tests/rig/cameras/gphoto2_command.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>

#include "tests/rig/simulated/raw_reader.h"

namespace {

using testing::HasSubstr;

struct Gphoto2Command : testing::Test {
  std::string run(const std::string& arguments) const { return gphoto2.run(arguments); }
  std::vector<std::byte> bytes_of(const std::string& name) const { return gphoto2.bytes_of(name); }

  WiredCamera wired;
  Gphoto2 gphoto2{wired};
};

}  // namespace

TEST_F(Gphoto2Command, FindsAnAlphaSevenTwo) {
  const std::string said = run("--summary");
  EXPECT_THAT(said, HasSubstr("Manufacturer: Sony Corporation"));
  EXPECT_THAT(said, HasSubstr("Model: ILCE-7M2"));
}

TEST_F(Gphoto2Command, ListsTheSettingsOfASony) {
  const std::string said = run("--list-config");
  for (const char* name :
       {"/iso", "/shutterspeed", "/f-number", "/imagequality", "/expprogram", "/focusmode", "/Battery Level"})
    EXPECT_THAT(said, HasSubstr(name));
}

TEST_F(Gphoto2Command, SetsAndReadsTheExposureAndTheQuality) {
  const std::array<std::pair<const char*, const char*>, 6> settings{{{"iso", "400"},
                                                                     {"shutterspeed", "1/125"},
                                                                     {"shutterspeed", "2"},
                                                                     {"f-number", "f/5.6"},
                                                                     {"imagequality", "RAW+JPEG (Fine)"},
                                                                     {"imagequality", "RAW"}}};
  for (const auto& [name, value] : settings) {
    run("--set-config '" + std::string(name) + "=" + value + "'");
    EXPECT_THAT(run("--get-config " + std::string(name)), HasSubstr("Current: " + std::string(value)));
  }
}

TEST_F(Gphoto2Command, ShowsALiveView) {
  run("--capture-preview");
  const auto jpeg = bytes_of("capture_preview.jpg");
  ASSERT_GT(jpeg.size(), 100u);
  EXPECT_EQ(jpeg[0], std::byte{0xff});
  EXPECT_EQ(jpeg[1], std::byte{0xd8});
}

TEST_F(Gphoto2Command, DownloadsTheRawPictureWhoseMosaicTheBenchDrew) {
  run("--set-config imagequality=RAW --capture-image-and-download");
  ASSERT_EQ(wired.recorded.count(), 1u);
  const auto bytes = bytes_of("capt0000.arw");
  EXPECT_EQ(bytes, wired.recorded.last().bytes);
  const ReadRaw read = read_raw(bytes), drawn = read_raw(wired.recorded.last().bytes);
  EXPECT_EQ(read.model, "ILCE-7M2");
  EXPECT_EQ(read.mosaic.size(), cv::Size(60, 40));
  EXPECT_EQ(cv::norm(read.mosaic, drawn.mosaic, cv::NORM_INF), 0);
}

TEST_F(Gphoto2Command, DownloadsRawAndJpegOfOneExposure) {
  run("--set-config 'imagequality=RAW+JPEG (Fine)' --capture-image-and-download");
  ASSERT_EQ(wired.recorded.count(), 1u);
  EXPECT_EQ(bytes_of("capt0000.arw"), wired.recorded.last().bytes);
  EXPECT_EQ(gphoto2.files_ending_in(".jpg"), 1u);
}

// Debian's own gphoto2 command against the simulated camera: what it says and what it downloads.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "tests/rig/cameras/wired_camera.h"
#include "tests/rig/simulated/raw_reader.h"

namespace {

using testing::HasSubstr;
namespace fs = std::filesystem;

struct Gphoto2Command : testing::Test {
  void SetUp() override {
    ASSERT_EQ(std::system("command -v gphoto2 >/dev/null"), 0) << "install gphoto2, as station/packages.txt says";
    fs::create_directories(folder);
  }
  ~Gphoto2Command() override { fs::remove_all(folder); }

  // What it prints; it remembers cameras in its home, so it gets one of its own.
  std::string run(const std::string& arguments) const {
    const std::string command = "cd " + folder.string() + " && HOME=" + folder.string() + " gphoto2 --port " +
                                wired.port() + " " + arguments + " 2>&1";
    std::string said;
    FILE* pipe = popen(command.c_str(), "r");
    std::array<char, 4096> piece{};
    for (std::size_t got = 0; (got = fread(piece.data(), 1, piece.size(), pipe)) > 0;) said.append(piece.data(), got);
    EXPECT_EQ(pclose(pipe), 0) << command << "\n" << said;
    return said;
  }
  std::vector<std::byte> bytes_of(const std::string& name) const {
    std::ifstream in(folder / name, std::ios::binary);
    EXPECT_TRUE(in) << name;
    const std::string text{std::istreambuf_iterator<char>(in), {}};
    const auto* begin = reinterpret_cast<const std::byte*>(text.data());
    return {begin, begin + text.size()};
  }

  WiredCamera wired;
  fs::path folder = fs::path(testing::TempDir()) / ("gphoto2_" + std::to_string(wired.server->port()));
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
  std::size_t jpegs = 0;
  for (const auto& entry : fs::directory_iterator(folder)) jpegs += entry.path().extension() == ".jpg";
  EXPECT_EQ(jpegs, 1u);
}

// Lens calibration from existing pictures, as a person types it.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "station/documents/lens_file.h"
#include "tests/calibration/geometry/synthetic_views.h"
#include "tests/places.h"
#include "tests/station/commands/program.h"

namespace station_test {
namespace {

namespace fs = std::filesystem;

using calibration::synthetic::narrow_lens;
constexpr const char* kPhotographs = "/usr/share/doc/opencv-doc/examples/data/";  // Debian's opencv-doc

std::string board(const std::string& name) {
  return std::string(DATA_DIR) + "/boards/" + name + ".json";
}

ProgramResult calibrate(const fs::path& images, const std::string& board_file, const fs::path& out,
                        std::vector<std::string> more = {}) {
  std::vector<std::string> arguments{"calibrate", "camera", "--images", images, "--board", board_file, "--out", out};
  arguments.insert(arguments.end(), more.begin(), more.end());
  return run_threadstation(arguments);
}

void expect_refused(const ProgramResult& result, const std::string& must_name) {
  EXPECT_EQ(result.status, 1);
  EXPECT_NE(result.error.find(must_name), std::string::npos) << result.error;
  EXPECT_EQ(result.error_lines(), 1) << result.error;
}

// A picture as a camera would store it: 8 bits with a display curve.
cv::Mat1b photograph(const calibration::Lens& lens, const calibration::TagLayout& layout,
                     const Eigen::Isometry3d& pose) {
  const cv::Mat1f linear = calibration::synthetic::picture(lens, layout, pose, 3);
  cv::Mat1b stored(linear.size());
  std::transform(linear.begin(), linear.end(), stored.begin(), [](float v) {
    const float display = v <= 0.0031308F ? 12.92F * v : 1.055F * std::pow(v, 1.F / 2.4F) - 0.055F;
    return cv::saturate_cast<uchar>(255.F * display);
  });
  return stored;
}

// Pictures of the fixture's tag board.
class TagPictures : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder = std::make_unique<TemporaryFolder>();
    fs::create_directory(*folder / "pictures");
    fs::create_directory(*folder / "mirrored");
    std::mt19937 random(31);
    int number = 10;
    for (const auto& pose : calibration::synthetic::handheld_poses(10, random)) {
      const cv::Mat1b stored = photograph(narrow_lens(), calibration::synthetic::board(), pose);
      const std::string name = std::to_string(number++) + ".png";
      cv::imwrite(*folder / ("pictures/" + name), stored);
      cv::Mat1b mirrored;
      cv::flip(stored, mirrored, 1);
      cv::imwrite(*folder / ("mirrored/" + name), mirrored);
    }
  }
  static void TearDownTestSuite() { folder.reset(); }

  static std::unique_ptr<TemporaryFolder> folder;
};
std::unique_ptr<TemporaryFolder> TagPictures::folder;

TEST_F(TagPictures, GiveTheLensThatTheyWereDrawnWith) {
  const auto out = *folder / "lens.json";
  const ProgramResult result =
      calibrate(*folder / "pictures", board("apriltag_3x4"), out, {"--quiet", "--tape-mm", "600"});
  ASSERT_EQ(result.status, 0) << result.error;
  const station::LensFile lens = station::parse_lens_file(station::read_json_file(out), out);
  EXPECT_EQ(lens.pictures.size(), 10U);
  EXPECT_NEAR(lens.fit.lens.fx_px, narrow_lens().fx_px, 5.0 * std::sqrt(lens.fit.covariance(0, 0)));
  EXPECT_LT(lens.fit.rms_px, 0.1);  // rendered without noise: what is left is 8 bits and 9 rays per pixel
  EXPECT_TRUE(fs::exists(*folder / "lens.cameramodel"));
}

TEST_F(TagPictures, ALensFileKeepsEveryDigitOfCornersAndCovariance) {
  const auto out = *folder / "again.json";
  ASSERT_EQ(calibrate(*folder / "pictures", board("apriltag_3x4"), out, {"--quiet"}).status, 0);
  const nlohmann::json document = station::read_json_file(out);
  EXPECT_EQ(station::to_json(station::parse_lens_file(document, "lens")), document);
}

TEST_F(TagPictures, ThatAreMirroredAreRefusedAsSuch) {
  expect_refused(calibrate(*folder / "mirrored", board("apriltag_3x4"), *folder / "m.json", {"--quiet"}), "mirrored");
}

TEST_F(TagPictures, AgainstATapeMeasureShowSizesThatAreWrongByTen) {
  nlohmann::json ten = station::read_json_file(board("apriltag_3x4"));
  ten["tag_mm"] = 200;
  ten["pitch_mm"] = 300;
  station::write_json_file(*folder / "ten.json", ten);
  expect_refused(
      calibrate(*folder / "pictures", *folder / "ten.json", *folder / "t.json", {"--quiet", "--tape-mm", "600"}),
      "tape measure");
}

TEST_F(TagPictures, OfAnotherSizeAreNamed) {
  fs::create_directory(*folder / "mixed");
  cv::imwrite(*folder / "mixed/a.png", cv::Mat1b(40, 60, uchar{200}));
  cv::imwrite(*folder / "mixed/b.png", cv::Mat1b(40, 64, uchar{200}));
  expect_refused(calibrate(*folder / "mixed", board("apriltag_3x4"), *folder / "x.json", {"--quiet"}), "b.png");
}

TEST_F(TagPictures, ThatAreThereFourTimesCountOnceAndAreNamed) {
  fs::copy(*folder / "pictures", *folder / "copied");
  for (const char* copy : {"a", "b", "c"})
    fs::copy(*folder / "pictures/12.png", *folder / ("copied/" + std::string(copy) + ".png"));
  const auto once = *folder / "once.json", more = *folder / "more.json";
  ASSERT_EQ(calibrate(*folder / "pictures", board("apriltag_3x4"), once, {"--quiet"}).status, 0);
  const ProgramResult result = calibrate(*folder / "copied", board("apriltag_3x4"), more, {"--quiet"});
  ASSERT_EQ(result.status, 0) << result.error;
  EXPECT_NE(result.error.find("c.png is the same picture as 12.png"), std::string::npos) << result.error;
  EXPECT_EQ(station::read_json_file(more)["lens"], station::read_json_file(once)["lens"]);
}

TEST_F(TagPictures, OfTwoCamerasOrTwoFocalLengthsAreNamed) {
  fs::copy(*folder / "pictures", *folder / "cameras");
  const auto take_with = [&](const std::string& name, const std::string& model, int focal_length_mm) {
    const std::string file = *folder / ("cameras/" + name), jpeg = file + ".jpg";
    cv::imwrite(jpeg, cv::imread(file, cv::IMREAD_GRAYSCALE));
    const std::string command = "exiv2 -M 'set Exif.Image.Make SONY' -M 'set Exif.Image.Model " + model +
                                "' -M 'set Exif.Photo.FocalLength " + std::to_string(focal_length_mm) + "/1' '" + jpeg +
                                "'";
    ASSERT_EQ(std::system(command.c_str()), 0);
    fs::remove(file);
  };
  for (int picture = 10; picture < 20; ++picture)
    take_with(std::to_string(picture) + ".png", picture < 17 ? "ILCE-6700" : "ILCE-7M4", 90);
  expect_refused(calibrate(*folder / "cameras", board("apriltag_3x4"), *folder / "x.json", {"--quiet"}),
                 "17.png.jpg was taken by SONY ILCE-7M4, the first by SONY ILCE-6700 (10.png.jpg)");
  for (int picture = 17; picture < 20; ++picture)
    fs::remove(*folder / ("cameras/" + std::to_string(picture) + ".png.jpg"));
  EXPECT_EQ(calibrate(*folder / "cameras", board("apriltag_3x4"), *folder / "x.json", {"--quiet"}).error.find("taken"),
            std::string::npos);
  fs::copy(*folder / "pictures/17.png", *folder / "cameras/17.png");
  take_with("17.png", "ILCE-6700", 70);
  expect_refused(calibrate(*folder / "cameras", board("apriltag_3x4"), *folder / "x.json", {"--quiet"}),
                 "17.png.jpg was taken at 70.0 mm focal length, the first at 90.0 mm");
}

TEST_F(TagPictures, OfALargerBoardThanTheFilesAreRefused) {
  nlohmann::json small = station::read_json_file(board("apriltag_3x4"));
  small["rows"] = 2;
  station::write_json_file(*folder / "small.json", small);
  expect_refused(calibrate(*folder / "pictures", *folder / "small.json", *folder / "x.json", {"--quiet"}),
                 "tags 8, 9, 10, 11 are printed on the board but not in");
}

TEST_F(TagPictures, OfABoardWithATagTwiceNameIt) {
  fs::create_directory(*folder / "twice");
  calibration::TagLayout twice = calibration::synthetic::board();
  twice.tags[7].id = 5;
  std::mt19937 random(31);
  int number = 10;
  for (const auto& pose : calibration::synthetic::handheld_poses(10, random))
    cv::imwrite(*folder / ("twice/" + std::to_string(number++) + ".png"), photograph(narrow_lens(), twice, pose));
  const ProgramResult result = calibrate(*folder / "twice", board("apriltag_3x4"), *folder / "twice.json", {"--quiet"});
  EXPECT_EQ(result.status, 0) << result.error;
  EXPECT_NE(result.error.find("tag 5 is there twice in "), std::string::npos) << result.error;
}

TEST_F(TagPictures, ThatBreakOffAreNamed) {
  for (const char* kind : {".jpg", ".png", ".tif"}) {
    const fs::path cut = *folder / ("cut" + std::string(kind + 1));
    fs::copy(*folder / "pictures", cut);
    const fs::path file = cut / ("99" + std::string(kind));
    cv::imwrite(file, cv::imread(*folder / "pictures/13.png", cv::IMREAD_GRAYSCALE));
    fs::resize_file(file, fs::file_size(file) * 2 / 3);
    expect_refused(calibrate(cut, board("apriltag_3x4"), *folder / "x.json", {"--quiet"}), file.filename());
  }
}

TEST(CalibrateCamera, PhotographsOfDebiansOpencvDocGiveTheLensThatMrcalsOwnToolGives) {
  ASSERT_TRUE(fs::exists(kPhotographs)) << "install opencv-doc, as station/packages.txt says";
  const TemporaryFolder folder;
  fs::create_directory(folder / "left");
  for (const auto& entry : fs::directory_iterator(kPhotographs))
    if (const std::string name = entry.path().filename().string(); name.size() == 10 && name.starts_with("left"))
      fs::copy(entry.path(), folder / "left");
  const ProgramResult result = calibrate(folder / "left", board("chessboard_6x9"), folder / "lens.json", {"--json"});
  ASSERT_EQ(result.status, 0) << result.error;
  const auto lens = nlohmann::json::parse(result.out)["lens"];
  EXPECT_NEAR(lens["focal_length_px"][0].get<double>(), 533.16, 0.2);
  EXPECT_NEAR(lens["focal_length_px"][1].get<double>(), 533.34, 0.2);
  nlohmann::json small = station::read_json_file(board("chessboard_6x9"));
  small["columns"] = 8;
  station::write_json_file(folder / "small.json", small);
  expect_refused(calibrate(folder / "left", folder / "small.json", folder / "lens.json", {"--quiet"}), "6 x 9");
}

TEST(CalibrateCamera, WhatCannotBeSolvedGetsOneLine) {
  const TemporaryFolder folder;
  const auto out = folder / "lens.json";
  expect_refused(calibrate(folder / "nowhere", board("apriltag_3x4"), out, {"--quiet"}), "--images");
  fs::create_directory(folder / "empty");
  expect_refused(calibrate(folder / "empty", board("apriltag_3x4"), out, {"--quiet"}), "no pictures");
  station::write_text_file(folder / "empty/broken.jpg", "not a picture");
  expect_refused(calibrate(folder / "empty", board("apriltag_3x4"), out, {"--quiet"}), "broken.jpg");
  fs::remove(folder / "empty/broken.jpg");
  cv::imwrite(folder / "empty/grey.png", cv::Mat1b(200, 300, uchar{128}));
  expect_refused(calibrate(folder / "empty", board("apriltag_3x4"), out, {"--quiet"}), "shows a tag");
  expect_refused(calibrate(folder / "empty", board("chessboard_6x9"), out, {"--quiet"}), "6 x 9");
  EXPECT_EQ(run_threadstation({"calibrate", "camera", "--images", folder / "empty"}).status, 2);
  EXPECT_EQ(run_threadstation({"calibrate", "--rig", folder / "rig.json"}).status, 2);
}

}  // namespace
}  // namespace station_test

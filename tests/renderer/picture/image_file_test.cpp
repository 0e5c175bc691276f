#include "renderer/picture/image_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <fstream>
#include <limits>
#include <opencv2/imgcodecs.hpp>

namespace renderer {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

class ImageFileTest : public testing::Test {
 protected:
  ImageFileTest() {
    std::string name = (fs::temp_directory_path() / "image_file_test_XXXXXX").string();
    folder_ = ::mkdtemp(name.data());
  }
  ~ImageFileTest() override { fs::remove_all(folder_); }

  fs::path folder_;
};

cv::Mat3f ramp() {
  cv::Mat3f image(20, 30);
  image.forEach([](cv::Vec3f& pixel, const int* at) {
    pixel = {static_cast<float>(at[0]) * 0.37f, static_cast<float>(at[1]) * 1e4f, -1e-6f};
  });
  return image;
}

template <class Function>
std::string error_of(const Function& function) {
  try {
    function();
  } catch (const std::runtime_error& error) {
    return error.what();
  }
  return "no error";
}

void cut_in_half(const fs::path& file) {
  fs::resize_file(file, fs::file_size(file) / 2);
}

TEST_F(ImageFileTest, ExrKeepsEveryBitOfFloats) {
  write_exr(folder_ / "a.exr", ramp());
  EXPECT_EQ(cv::norm(read_exr(folder_ / "a.exr"), ramp(), cv::NORM_INF), 0);
}

TEST_F(ImageFileTest, ExrSaysNothingAboutWhenItWasWritten) {
  write_exr(folder_ / "a.exr", ramp());
  ImageHeader header;
  read_exr(folder_ / "a.exr", &header);
  EXPECT_THAT(header["DateTime"], Not(HasSubstr("20"))) << "pictures made again must be the same files";
}

TEST_F(ImageFileTest, ExrKeepsRowsThatAreNotContiguous) {
  const cv::Mat3f part = ramp()(cv::Rect(3, 4, 10, 8));
  write_exr(folder_ / "a.exr", part);
  EXPECT_EQ(cv::norm(read_exr(folder_ / "a.exr"), part, cv::NORM_INF), 0);
}

TEST_F(ImageFileTest, ExrIsWrittenWithoutCompressionWhereThatIsAskedFor) {
  write_exr(folder_ / "zip.exr", ramp());
  write_exr(folder_ / "none.exr", ramp(), {{"a", "b"}}, ExrCompression::none);
  EXPECT_EQ(cv::norm(read_exr(folder_ / "none.exr"), ramp(), cv::NORM_INF), 0);
  EXPECT_GT(fs::file_size(folder_ / "none.exr"), 20 * 30 * 3 * sizeof(float));
  EXPECT_LT(fs::file_size(folder_ / "zip.exr"), fs::file_size(folder_ / "none.exr") / 2);
}

TEST_F(ImageFileTest, ExrKeepsItsHeader) {
  const ImageHeader written{{"threadstation:unit", "radiance per second"}, {"threadstation:view", "r03"}};
  write_exr(folder_ / "a.exr", ramp(), written);
  ImageHeader read;
  read_exr(folder_ / "a.exr", &read);
  for (const auto& [name, text] : written) EXPECT_EQ(read[name], text);
}

TEST_F(ImageFileTest, ExrKeepsNamedChannelsOfEachKindBesideTheColours) {
  cv::Mat planes[3];
  cv::split(ramp(), planes);
  planes[1] *= 1e-4;
  const cv::Mat depth = planes[0] * 1e5 + 1e5;  // more than half has room for
  cv::Mat1i ids(20, 30, 0);
  ids(3, 4) = static_cast<int>(0xfedcba98u);
  const cv::Mat bright = planes[0] * 1e6;
  write_exr(folder_ / "a.exr",
            {{"R", planes[0], true}, {"G", planes[1], true}, {"B", bright, true}, {"depth.Z", depth}, {"yarn.id", ids}},
            {{"threadstation/scene", "test"}});
  ImageHeader header;
  const cv::Mat3f colours = read_exr(folder_ / "a.exr", &header);
  EXPECT_EQ(header["threadstation/scene"], "test");
  EXPECT_NEAR(colours(7, 8)[0], 7 * 0.37f, 2e-3) << "11 bits of 2.6";
  EXPECT_NEAR(colours(7, 8)[1], 8, 1e-6) << "small integers are exact";
  EXPECT_EQ(colours(7, 8)[2], 65504) << "clipped, not infinite";
  std::map<std::string, ExrChannel> read;
  for (const ExrChannel& channel : read_exr_channels(folder_ / "a.exr")) read[channel.name] = channel;
  ASSERT_EQ(read.size(), 5u);
  EXPECT_TRUE(read["R"].half);
  EXPECT_FALSE(read["depth.Z"].half);
  EXPECT_EQ(cv::norm(read["depth.Z"].plane, depth, cv::NORM_INF), 0);
  EXPECT_EQ(cv::norm(read["yarn.id"].plane, ids, cv::NORM_INF), 0);
  EXPECT_EQ(cv::norm(read["R"].plane, planes[0], cv::NORM_INF) < 4e-3, true);
}

TEST_F(ImageFileTest, ExrOfNamedColoursAloneIsTheOrdinaryFile) {
  cv::Mat planes[3];
  cv::split(ramp(), planes);
  write_exr(folder_ / "a.exr", {{"R", planes[0]}, {"G", planes[1]}, {"B", planes[2]}});
  EXPECT_EQ(cv::norm(read_exr(folder_ / "a.exr"), ramp(), cv::NORM_INF), 0);
  EXPECT_THAT(error_of([&] {
                write_exr(folder_ / "b.exr", {{"R", planes[0]}, {"G", cv::Mat1f(2, 2)}});
              }),
              HasSubstr("channel G"));
  EXPECT_THAT(error_of([&] { write_exr(folder_ / "b.exr", std::vector<ExrChannel>{}); }), HasSubstr("no channel"));
}

TEST_F(ImageFileTest, PngKeepsMasksAndColours) {
  cv::Mat1b mask(20, 30, uchar{0});
  mask(3, 4) = 255;
  write_png(folder_ / "mask.png", mask);
  EXPECT_EQ(cv::norm(read_png_grey(folder_ / "mask.png"), mask, cv::NORM_INF), 0);
  write_png(folder_ / "colour.png", cv::Mat3b(20, 30, cv::Vec3b(10, 20, 30)));
  EXPECT_EQ(read_png_grey(folder_ / "colour.png")(5, 5), 10);  // the first channel is red
  EXPECT_EQ(encode_png(cv::Mat3b(2, 2, cv::Vec3b(1, 2, 3))).substr(1, 3), "PNG");
}

TEST_F(ImageFileTest, NothingButTheFileIsLeftInTheFolder) {
  write_exr(folder_ / "a.exr", ramp());
  EXPECT_EQ(std::distance(fs::directory_iterator(folder_), {}), 1);
}

TEST_F(ImageFileTest, AMissingFileIsNamed) {
  EXPECT_THAT(error_of([&] { read_exr(folder_ / "no.exr"); }), AllOf(HasSubstr("no.exr"), HasSubstr("no such file")));
}

TEST_F(ImageFileTest, AFileCutShortGivesOneClearLine) {
  write_exr(folder_ / "a.exr", ramp());
  cut_in_half(folder_ / "a.exr");
  EXPECT_THAT(error_of([&] { read_exr(folder_ / "a.exr"); }),
              AllOf(HasSubstr("a.exr"), HasSubstr("make it again"), Not(HasSubstr("\n"))));
  cv::Mat1b noise(200, 200);
  cv::randu(noise, 0, 255);
  write_png(folder_ / "a.png", noise);
  cut_in_half(folder_ / "a.png");
  EXPECT_THAT(error_of([&] { read_png_grey(folder_ / "a.png"); }),
              AllOf(HasSubstr("a.png"), HasSubstr("make it again"), Not(HasSubstr("\n"))));
  std::ofstream(folder_ / "empty.exr").close();
  EXPECT_THAT(error_of([&] { read_exr(folder_ / "empty.exr"); }), HasSubstr("empty.exr"));
}

TEST_F(ImageFileTest, AFolderThatDoesNotExistGivesOneClearLine) {
  EXPECT_THAT(error_of([&] { write_exr(folder_ / "no" / "a.exr", ramp()); }),
              AllOf(HasSubstr("a.exr"), HasSubstr("No such file"), HasSubstr("check that the folder")));
}

TEST_F(ImageFileTest, AFullDiskGivesOneClearLineAndLeavesTheOldFile) {
  // The device that is always full stands in for the disk: the temporary file is a link to it.
  const fs::path file = folder_ / "a.exr";
  write_exr(file, ramp());
  fs::create_symlink("/dev/full", file.string() + "." + std::to_string(::getpid()) + ".partial");
  EXPECT_THAT(error_of([&] { write_exr(file, cv::Mat3f(5, 5)); }),
              AllOf(HasSubstr("a.exr"), HasSubstr("No space left")));
  EXPECT_EQ(cv::norm(read_exr(file), ramp(), cv::NORM_INF), 0);
  EXPECT_EQ(std::distance(fs::directory_iterator(folder_), {}), 1);
}

TEST(EncodeSrgbTest, MapsBlackMiddleGreyAndWhiteAsTheStandardDoes) {
  const cv::Mat3f image = (cv::Mat_<cv::Vec3f>(1, 2) << cv::Vec3f(0, 0.5f, 1), cv::Vec3f(-1, 0.001f, 7));
  const cv::Mat3b encoded = encode_srgb(image, 1);
  EXPECT_EQ(encoded(0, 0), cv::Vec3b(0, 188, 255));
  EXPECT_EQ(encoded(0, 1), cv::Vec3b(0, 3, 255));  // 0.001 is on the linear foot: 12.92 / 1000 * 255
}

TEST(EncodeSrgbTest, AppliesTheColourMatrixAndTheScale) {
  const cv::Matx33f swap(0, 0, 1, 0, 1, 0, 1, 0, 0);
  EXPECT_EQ(encode_srgb(cv::Mat3f(1, 1, cv::Vec3f(0.5f, 0.25f, 0)), 2, swap)(0, 0), cv::Vec3b(0, 188, 255));
}

// The same patches in each of the formats; transparent ones show the white below them.
TEST_F(ImageFileTest, PicturesForPeopleAreLinearSrgbOverWhite) {
  const cv::Vec3b orange(188, 64, 0);
  const cv::Vec3f linear(0.5029F, 0.0513F, 0);
  write_png(folder_ / "a.png", cv::Mat3b(16, 16, orange));
  cv::Mat3b bgr(16, 16, cv::Vec3b(orange[2], orange[1], orange[0]));
  cv::imwrite((folder_ / "a.jpg").string(), bgr, {cv::IMWRITE_JPEG_QUALITY, 100});
  write_exr(folder_ / "a.exr", cv::Mat3f(16, 16, linear));
  cv::imwrite((folder_ / "transparent.png").string(), cv::Mat4b(16, 16, cv::Vec4b(0, 64, 188, 51)));
  cv::imwrite((folder_ / "deep.png").string(), cv::Mat_<cv::Vec3w>(16, 16, cv::Vec3w(0, 64 * 257, 188 * 257)));
  write_png(folder_ / "grey.png", cv::Mat1b(16, 16, uchar{188}));
  const auto is = [&](const char* name, const cv::Vec3f& expected, double tolerance) {
    const cv::Mat3f read = read_linear_srgb(folder_ / name);
    EXPECT_EQ(read.size(), cv::Size(16, 16)) << name;
    EXPECT_LT(cv::norm(read, cv::Mat3f(16, 16, expected), cv::NORM_INF), tolerance) << name << ": " << read(8, 8);
  };
  is("a.png", linear, 1e-4), is("a.jpg", linear, 0.02), is("a.exr", linear, 1e-6), is("deep.png", linear, 1e-4);
  is("grey.png", {0.5029F, 0.5029F, 0.5029F}, 1e-4);
  is("transparent.png", 0.2F * linear + cv::Vec3f(0.8F, 0.8F, 0.8F), 2e-3);
}

// TIFF files are for photographs alone; those of OpenCV stand for what other programs write.
TEST_F(ImageFileTest, PhotographsAreAlsoTiffFilesOfEightAndSixteenBitsAndFloats) {
  const cv::Vec3f linear(0.5029F, 0.0513F, 0);
  cv::imwrite(folder_ / "a.tif", cv::Mat3b(16, 16, cv::Vec3b(0, 64, 188)));
  cv::imwrite(folder_ / "deep.tif", cv::Mat_<cv::Vec3w>(16, 16, cv::Vec3w(0, 64 * 257, 188 * 257)));
  cv::imwrite(folder_ / "grey.tif", cv::Mat1w(16, 16, ushort{188 * 257}));
  cv::imwrite(folder_ / "float.tif", cv::Mat3f(16, 16, cv::Vec3f(linear[2], linear[1], linear[0])),
              {cv::IMWRITE_TIFF_COMPRESSION, 1});
  cv::Mat1b corner(16, 16, uchar{0});
  corner(2, 13) = 255;
  cv::imwrite(folder_ / "corner.tif", corner);
  write_png(folder_ / "a.png", cv::Mat3b(16, 16, cv::Vec3b(188, 64, 0)));
  for (const char* name : {"a.tif", "deep.tif", "float.tif", "a.png"})
    EXPECT_LT(cv::norm(read_photograph(folder_ / name), cv::Mat3f(16, 16, linear), cv::NORM_INF), 1e-4) << name;
  EXPECT_NEAR(read_photograph(folder_ / "grey.tif")(3, 4)[2], 0.5029F, 1e-4);
  EXPECT_EQ(read_photograph(folder_ / "corner.tif")(2, 13), cv::Vec3f(1, 1, 1));
  EXPECT_EQ(read_photograph(folder_ / "corner.tif")(13, 13), cv::Vec3f(0, 0, 0));
  cut_in_half(folder_ / "deep.tif");
  EXPECT_THAT(error_of([&] { read_photograph(folder_ / "deep.tif"); }),
              AllOf(HasSubstr("deep.tif"), HasSubstr("make it again"), Not(HasSubstr("\n"))));
  EXPECT_THAT(error_of([&] { read_linear_srgb(folder_ / "a.tif"); }), HasSubstr("none of PNG, JPEG and EXR"));
}

TEST_F(ImageFileTest, PicturesForPeopleOfExrMayBeGreyOrTransparent) {
  const cv::Mat half(4, 4, CV_32F, cv::Scalar(0.5)), quarter(4, 4, CV_32F, cv::Scalar(0.25));
  write_exr(folder_ / "grey.exr", std::vector<ExrChannel>{{"Y", half}});
  EXPECT_EQ(read_linear_srgb(folder_ / "grey.exr")(1, 2), cv::Vec3f(0.5F, 0.5F, 0.5F));
  write_exr(folder_ / "over.exr", {{"R", quarter}, {"G", half}, {"B", half}, {"A", half}});
  EXPECT_EQ(read_linear_srgb(folder_ / "over.exr")(1, 2), cv::Vec3f(0.75F, 1, 1)) << "its colours are multiplied";
  write_exr(folder_ / "depth.exr", std::vector<ExrChannel>{{"Z", half}});
  EXPECT_THAT(error_of([&] { read_linear_srgb(folder_ / "depth.exr"); }), HasSubstr("no channel R"));
}

TEST_F(ImageFileTest, PicturesForPeopleThatAreNoneAreOneLine) {
  const auto refused = [&](const fs::path& file, const char* why) {
    EXPECT_THAT(error_of([&] { read_linear_srgb(file); }),
                AllOf(HasSubstr(file.string()), HasSubstr(why), Not(HasSubstr("\n"))));
  };
  refused(folder_ / "none.png", "no such file");
  refused(folder_, "no such file");
  std::ofstream(folder_ / "text.png") << "text";
  refused(folder_ / "text.png", "none of PNG, JPEG and EXR");
  std::ofstream(folder_ / "empty.png");
  refused(folder_ / "empty.png", "none of PNG, JPEG and EXR");
  write_png(folder_ / "cut.png", cv::Mat3b(64, 64, cv::Vec3b(1, 2, 3)));
  cut_in_half(folder_ / "cut.png");
  refused(folder_ / "cut.png", "not a complete PNG");
  cv::Mat_<cv::Vec3w> noise(64, 64);
  cv::randu(noise, 0, 65535);
  cv::imwrite(folder_ / "deep.png", noise);
  cut_in_half(folder_ / "deep.png");
  testing::internal::CaptureStderr();
  refused(folder_ / "deep.png", "not a complete PNG");
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "") << "the library's own words";
  cv::Mat3f values(4, 4, cv::Vec3f(1, 1, 1));
  values(2, 2)[1] = std::numeric_limits<float>::quiet_NaN();
  write_exr(folder_ / "nan.exr", values);
  refused(folder_ / "nan.exr", "no numbers");
  std::ofstream(folder_ / "begin.jpg", std::ios::binary) << "\xff\xd8\xff\xe0 and no more";
  refused(folder_ / "begin.jpg", "damaged");
}

}  // namespace
}  // namespace renderer

#include "calibration/develop/develop.h"

#include <gtest/gtest.h>

#include <functional>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>

#include "calibration/develop/demosaic.h"
#include "calibration/develop/linear_grey.h"
#include "tests/calibration/geometry/synthetic_views.h"

namespace calibration {
namespace {

// Radiance of channel c at (column, row), in the radiance unit.
using Scene = std::function<double(double column, double row, int channel)>;

SensorPicture photographed(const Scene& scene, cv::Size size, double exposure_s = 0.5,
                           std::array<int, 4> cell = {0, 1, 1, 2}) {
  SensorPicture raw{.mosaic = cv::Mat1w(size),
                    .channel = cell,
                    .black_level_dn = 512,
                    .white_level_dn = 16383,
                    .exposure_s = exposure_s,
                    .f_number = 8,
                    .iso = 100,
                    .make = {},
                    .model = {},
                    .serial = {},
                    .date_time = {}};
  for (int row = 0; row < size.height; ++row) {
    for (int column = 0; column < size.width; ++column) {
      const int channel = cell[static_cast<std::size_t>(2 * (row % 2) + column % 2)];
      const double dn = 512 + 15871 * exposure_s * scene(column, row, channel);
      raw.mosaic(row, column) = static_cast<ushort>(std::clamp(std::lround(dn), 0L, 16383L));
    }
  }
  return raw;
}

// Half a DN of rounding in the raw picture, as radiance.
constexpr double kRounding = 0.51 / (15871 * 0.5);

TEST(Develop, AConstantColourComesBackEverywhereForEveryLayoutOfTheMosaic) {
  const std::array<double, 3> colour{0.2, 0.7, 0.4};
  for (const std::array<int, 4> cell : {std::array<int, 4>{0, 1, 1, 2}, {2, 1, 1, 0}, {1, 0, 2, 1}, {1, 2, 0, 1}}) {
    const auto raw =
        photographed([&](double, double, int c) { return colour[static_cast<std::size_t>(c)]; }, {31, 22}, 0.5, cell);
    const Developed out = develop(raw, {});
    for (const cv::Vec3f& pixel : out.radiance)
      for (int c = 0; c < 3; ++c) EXPECT_NEAR(pixel[c], colour[static_cast<std::size_t>(c)], kRounding);
    EXPECT_EQ(cv::countNonZero(out.saturated), 0);
  }
}

TEST(Develop, ALinearRampComesBackInsideThePicture) {
  const Scene ramp = [](double column, double row, int c) { return 0.1 + 0.01 * column + 0.004 * (c + 1) * row; };
  const Developed out = develop(photographed(ramp, {40, 30}), {});
  for (int row = 1; row < 29; ++row) {
    for (int column = 1; column < 39; ++column)
      for (int c = 0; c < 3; ++c) EXPECT_NEAR(out.radiance(row, column)[c], ramp(column, row, c), kRounding);
  }
}

TEST(Develop, RadianceDoesNotDependOnTheExposureTime) {
  const Scene scene = [](double, double, int c) { return 0.05 * (c + 1); };
  const cv::Vec3f one = develop(photographed(scene, {8, 8}, 0.25), {}).radiance(4, 4);
  const cv::Vec3f other = develop(photographed(scene, {8, 8}, 4.0), {}).radiance(4, 4);
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(one[c], other[c], 0.51 / (15871 * 0.25));
}

TEST(Develop, TheDarkFrameTakesThePlaceOfTheBlackLevelAndNoiseBelowItIsKept) {
  SensorPicture raw = photographed([](double, double, int) { return 0.0; }, {8, 8}, 1.0);
  const cv::Mat1f dark(8, 8, 512.0F + 3.5F);
  const Developed out = develop(raw, {.dark_dn = dark});
  for (const cv::Vec3f& pixel : out.radiance) EXPECT_NEAR(pixel[1], -3.5 / 15871, 1e-7);
}

TEST(Develop, TheMasterDarkIsTheMean) {
  std::vector<SensorPicture> darks;
  for (int i = 0; i < 4; ++i) {
    darks.push_back(photographed([](double, double, int) { return 0.0; }, {4, 4}, 1.0));
    darks.back().mosaic += i;
  }
  EXPECT_FLOAT_EQ(master_dark(darks)(2, 3), 513.5F);
  darks[1].iso = 400;
  EXPECT_THROW(master_dark(darks), std::runtime_error);
  darks[1].iso = 100;
  darks[1].exposure_s = 2.0;
  EXPECT_THROW(master_dark(darks), std::runtime_error);
  darks[1] = photographed([](double, double, int) { return 0.0; }, {6, 4}, 1.0);
  EXPECT_THROW(master_dark(darks), std::runtime_error);
  EXPECT_THROW(master_dark({}), std::runtime_error);
}

TEST(Develop, VignettingIsTakenOut) {
  const Vignetting vignetting{.v0 = -0.25, .v1 = -0.05};
  const cv::Size size(60, 40);
  const Scene scene = [&](double column, double row, int) { return 0.6 * vignetting.gain(column, row, size); };
  const Developed out = develop(photographed(scene, size), {.vignetting = vignetting});
  for (const cv::Vec3f& pixel : out.radiance)
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(pixel[c], 0.6, kRounding / 0.69);  // the smallest gain is 0.7
}

TEST(Develop, UndistortionPutsAPointWhereAPinholeWithTheSameMatrixSeesIt) {
  const Lens lens = synthetic::narrow_lens();
  Lens pinhole = lens;
  pinhole.distortion = {};
  const Eigen::Vector3d point(60, 40, 600);  // near the corner, where the distortion moves it by about half a pixel
  const Eigen::Vector2d seen = synthetic::project(lens, point), straight = synthetic::project(pinhole, point);
  ASSERT_GT((seen - straight).norm(), 0.3);
  const Scene spot = [&](double column, double row, int) {
    return 0.5 * std::exp(-(Eigen::Vector2d(column, row) - seen).squaredNorm() / (2 * 3.0 * 3.0));
  };
  const Developed out = develop(photographed(spot, {600, 400}), {.lens = lens});
  cv::Mat1f green;
  cv::extractChannel(out.radiance, green, 1);
  const cv::Moments moments = cv::moments(green);
  // centroid of a noiseless spot; rounding to 14 bits and to 1/32 px in the resampling leave less than 0.03 px
  EXPECT_NEAR(moments.m10 / moments.m00, straight.x(), 0.03);
  EXPECT_NEAR(moments.m01 / moments.m00, straight.y(), 0.03);
}

SensorPicture noise(cv::Size size, std::array<int, 4> cell) {
  SensorPicture raw = photographed([](double, double, int) { return 0.0; }, size, 0.5, cell);
  cv::RNG random(5);
  random.fill(raw.mosaic, cv::RNG::UNIFORM, 400, 16383);
  return raw;
}

TEST(Develop, RowsMayBeDemosaicedInAnyParts) {
  LinearMosaic mosaic = merge_exposures({noise({41, 30}, {0, 1, 1, 2})}, {});
  mosaic.variance = mosaic.radiance.clone();
  const auto in_parts = [&](const std::vector<int>& ends) {
    Developed out{.radiance = cv::Mat3f(mosaic.radiance.size()),
                  .variance = cv::Mat3f(mosaic.radiance.size()),
                  .saturated = cv::Mat1b(mosaic.radiance.size())};
    int begin = 0;
    for (const int end : ends) demosaic_rows(mosaic, {begin, end}, out), begin = end;
    return out;
  };
  const Developed once = in_parts({30}), parts = in_parts({1, 8, 15, 30});
  EXPECT_EQ(cv::norm(once.radiance, parts.radiance, cv::NORM_INF), 0);
  EXPECT_EQ(cv::norm(once.variance, parts.variance, cv::NORM_INF), 0);
  EXPECT_EQ(cv::norm(once.saturated, parts.saturated, cv::NORM_INF), 0);
}

// Odd corners and odd sizes, with a bad pixel outside that mends one inside, maps, vignetting and a saturated value.
TEST(Develop, APartIsWhatTheWholePictureHasThere) {
  const Scene scene = [](double column, double row, int c) { return 0.2 + 0.01 * column + 0.02 * row + 0.05 * c; };
  SensorPicture raw = photographed(scene, {40, 30});
  raw.mosaic(13, 9) = 16383;
  SensorResponse response;
  response.gain_dn_per_e = 0.3, response.read_noise_e = 5;
  response.maps.bias_dn = cv::Mat1f(raw.mosaic.size());
  cv::randu(response.maps.bias_dn, 508, 516);
  response.maps.flat = cv::Mat1f(raw.mosaic.size());
  cv::randu(response.maps.flat, 0.98, 1.02);
  response.maps.bad = cv::Mat1b(raw.mosaic.size(), uchar{0});
  for (const cv::Point& at : {cv::Point(9, 10), cv::Point(7, 10), cv::Point(20, 21), cv::Point(22, 23)})
    response.maps.bad(at) = 255;
  DevelopOptions options{.response = &response, .vignetting = Vignetting{.v0 = 0.1, .v1 = 0.02}};
  const Developed whole = develop(raw, options);
  for (const cv::Rect& part : {cv::Rect(9, 11, 13, 10), cv::Rect(0, 0, 5, 3), cv::Rect(33, 27, 7, 3)}) {
    options.part = part;
    const Developed cut = develop(raw, options);
    ASSERT_EQ(cut.radiance.size(), part.size());
    EXPECT_EQ(cv::norm(cut.radiance, whole.radiance(part), cv::NORM_INF), 0) << part;
    EXPECT_EQ(cv::norm(cut.variance, whole.variance(part), cv::NORM_INF), 0) << part;
    EXPECT_EQ(cv::norm(cut.saturated, whole.saturated(part), cv::NORM_INF), 0) << part;
  }
  options.part = cv::Rect(30, 20, 11, 10);
  EXPECT_THROW(develop(raw, options), std::runtime_error);
}

// The variance of a mean of values with the same variance is that over their number.
TEST(Develop, WhatAColourIsMadeFromMakesItsVariance) {
  LinearMosaic mosaic = merge_exposures({noise({8, 8}, {0, 1, 1, 2})}, {});
  mosaic.variance = cv::Mat1f(mosaic.radiance.size(), 0.4F);
  Developed out{.radiance = cv::Mat3f(mosaic.radiance.size()),
                .variance = cv::Mat3f(mosaic.radiance.size()),
                .saturated = cv::Mat1b(mosaic.radiance.size())};
  demosaic_rows(mosaic, {0, 8}, out);
  EXPECT_LT(cv::norm(out.variance(4, 4) - cv::Vec3f(0.4F, 0.1F, 0.1F)), 1e-6) << "a red site";
  EXPECT_LT(cv::norm(out.variance(4, 5) - cv::Vec3f(0.2F, 0.4F, 0.2F)), 1e-6) << "a green one";
}

TEST(Develop, BandsOfAStraightenedPictureFitTogether) {
  Lens lens = synthetic::narrow_lens();
  const Developed seen = develop(noise({lens.width_px, lens.height_px}, {0, 1, 1, 2}), {});
  const Developed straight = develop(noise({lens.width_px, lens.height_px}, {0, 1, 1, 2}), {.lens = lens});
  const cv::Matx33d matrix(lens.fx_px, 0, lens.cx_px, 0, lens.fy_px, lens.cy_px, 0, 0, 1);
  cv::Mat3f expected;
  cv::Mat1f column, row;
  cv::initUndistortRectifyMap(matrix, std::vector<double>(lens.distortion.begin(), lens.distortion.end()),
                              cv::noArray(), matrix, seen.radiance.size(), CV_32FC1, column, row);
  cv::remap(seen.radiance, expected, column, row, cv::INTER_LINEAR, cv::BORDER_CONSTANT);
  // Places are rounded to 1/32 px: a few pixels fall to the other side.
  cv::Mat1b different;
  cv::inRange(straight.radiance - expected, cv::Scalar::all(-1e-6), cv::Scalar::all(1e-6), different);
  EXPECT_LT(straight.radiance.total() - static_cast<std::size_t>(cv::countNonZero(different)),
            straight.radiance.total() / 1000);
}

TEST(LinearGrey, IsTheMeanOfTheDevelopedColoursAndNotBelowZero) {
  for (const std::array<int, 4> cell :
       {std::array<int, 4>{0, 1, 1, 2}, {2, 1, 1, 0}, {1, 0, 2, 1}, {1, 1, 1, 1}, {0, 0, 2, 1}}) {
    const SensorPicture raw = noise({31, 22}, cell);
    const cv::Mat3f radiance = develop(raw, {}).radiance;
    const cv::Mat1f grey = linear_grey(raw);
    for (int row = 0; row < grey.rows; ++row)
      for (int column = 0; column < grey.cols; ++column) {
        const cv::Vec3f& pixel = radiance(row, column);
        ASSERT_NEAR(grey(row, column), std::max(0.F, (pixel[0] + pixel[1] + pixel[2]) / 3), 1e-5)
            << row << ' ' << column;
      }
  }
}

TEST(LinearGrey, RefusesWhatCannotBeDeveloped) {
  SensorPicture raw = noise({8, 8}, {0, 1, 1, 3});
  EXPECT_THROW(linear_grey(raw), std::runtime_error);
  raw.channel[3] = 2;
  raw.exposure_s = 0;
  EXPECT_THROW(linear_grey(raw), std::runtime_error);
}

TEST(Develop, EveryPixelMadeFromASaturatedValueIsMarkedAndNoOther) {
  SensorPicture raw = photographed([](double, double, int) { return 0.2; }, {12, 10});
  raw.mosaic(4, 6) = 16383;  // a red site
  const Developed red = develop(raw, {});
  for (int row = 0; row < 10; ++row) {
    for (int column = 0; column < 12; ++column) {
      const bool near = std::abs(row - 4) <= 1 && std::abs(column - 6) <= 1;
      EXPECT_EQ(red.saturated(row, column) > 0, near) << row << ' ' << column;
    }
  }
  raw.mosaic(4, 6) = 2000;
  raw.mosaic(4, 5) = 16100;  // a green site, above 0.98 of the range: its diagonal neighbours are green themselves
  const Developed green = develop(raw, {});
  EXPECT_EQ(cv::countNonZero(green.saturated), 5);
  EXPECT_EQ(green.saturated(3, 4), 0);
  EXPECT_EQ(green.saturated(3, 5), 255);
}

TEST(Develop, ANarrowHighlightDoesNotMakeNegativeRadianceWhenItIsUndistorted) {
  const Scene edge = [](double column, double, int) { return column > 450 ? 1.9 : 0.0; };
  const Developed out = develop(photographed(edge, {600, 400}), {.lens = synthetic::narrow_lens()});
  for (const cv::Vec3f& pixel : out.radiance)
    for (int c = 0; c < 3; ++c) ASSERT_GE(pixel[c], 0.0F);
}

TEST(Develop, WrongSizesAndMissingExposuresAreRefused) {
  SensorPicture raw = photographed([](double, double, int) { return 0.2; }, {8, 8});
  EXPECT_THROW(develop(raw, {.dark_dn = cv::Mat1f(6, 8, 512.0F)}), std::runtime_error);
  EXPECT_THROW(develop(raw, {.lens = synthetic::narrow_lens()}), std::runtime_error);
  raw.exposure_s = 0.0;
  EXPECT_THROW(develop(raw, {}), std::runtime_error);
  EXPECT_THROW(develop(SensorPicture{}, {}), std::runtime_error);
}

}  // namespace
}  // namespace calibration

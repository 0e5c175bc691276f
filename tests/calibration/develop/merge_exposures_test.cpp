#include "calibration/develop/merge_exposures.h"

#include <gtest/gtest.h>

#include <cmath>

#include "calibration/develop/develop.h"
#include "tests/calibration/sensor/simulated_sensor.h"

namespace calibration {
namespace {

SensorPicture flat_picture(double signal_dn, double exposure_s, cv::Size size = {12, 10}) {
  return {.mosaic = cv::Mat1w(size, static_cast<ushort>(std::lround(512 + signal_dn))),
          .channel = {0, 1, 1, 2},
          .black_level_dn = 512,
          .white_level_dn = 16383,
          .exposure_s = exposure_s,
          .f_number = 8,
          .iso = 100,
          .make = {},
          .model = {},
          .serial = {},
          .date_time = {}};
}

const SensorResponse kResponse{.gain_dn_per_e = 0.3174, .read_noise_e = 5};

TEST(MergeExposures, OneExposureIsSignalOverTime) {
  const LinearMosaic merged = merge_exposures({flat_picture(1587.1, 0.5)}, {});
  EXPECT_NEAR(merged.radiance(3, 3), 1587.0 / 15871 / 0.5, 1e-6);
  EXPECT_TRUE(merged.variance.empty());
}

TEST(MergeExposures, TheVarianceOfTwoEqualExposuresIsHalf) {
  const SensorPicture raw = flat_picture(3000, 0.5);
  const double one = merge_exposures({raw}, kResponse).variance(2, 2);
  const double expected = (0.3174 * 3000 + std::pow(0.3174 * 5, 2)) / std::pow(15871 * 0.5, 2);
  EXPECT_NEAR(one / expected, 1, 1e-5);
  EXPECT_NEAR(merge_exposures({raw, raw}, kResponse).variance(2, 2) / one, 0.5, 1e-5);
}

TEST(MergeExposures, ABrighterExposureWeighsMoreAndASaturatedOneNothing) {
  const SensorPicture brief = flat_picture(1000, 0.1), lasting = flat_picture(4400, 0.4);
  const double merged = merge_exposures({brief, lasting}, kResponse).radiance(2, 2) * 15871;
  EXPECT_GT(merged, (1e4 + 1.1e4) / 2);  // 1e4 per second by the brief one, 1.1e4 by the lasting one
  EXPECT_LT(merged, 1.1e4);
  const SensorPicture saturated = flat_picture(15871, 1.6);
  EXPECT_NEAR(merge_exposures({brief, saturated}, kResponse).radiance(2, 2) * 15871, 1e4, 1e-2);
  EXPECT_EQ(cv::countNonZero(merge_exposures({brief, saturated}, kResponse).saturated), 0);
  const SensorPicture bright = flat_picture(15100, 1.5);  // 0.95 of the range: not saturated, but no weight
  EXPECT_NEAR(merge_exposures({brief, bright}, kResponse).radiance(2, 2) * 15871, 1e4, 1e-2);
}

TEST(MergeExposures, TheNeighboursOfASaturatedValueComeFromTheShorterExposure) {
  const SensorPicture brief = flat_picture(1000, 0.1);
  SensorPicture lasting = flat_picture(8000, 0.4);  // twice as bright as the brief one says
  lasting.mosaic(5, 6) = 16383;
  const LinearMosaic merged = merge_exposures({brief, lasting}, kResponse);
  for (int row = 0; row < 10; ++row)
    for (int column = 0; column < 12; ++column) {
      const bool beside = std::abs(row - 5) <= 1 && std::abs(column - 6) <= 1;
      EXPECT_EQ(merged.radiance(row, column) * 15871 < 1.01e4, beside) << row << ' ' << column;
    }
}

TEST(MergeExposures, WhatIsSaturatedInTheShortestIsMarked) {
  SensorPicture brief = flat_picture(1000, 0.1), lasting = flat_picture(4000, 0.4);
  brief.mosaic(4, 4) = lasting.mosaic(4, 4) = 16383;
  const LinearMosaic merged = merge_exposures({lasting, brief}, kResponse);
  EXPECT_EQ(cv::countNonZero(merged.saturated), 1);
  EXPECT_EQ(merged.saturated(4, 4), 255);
}

TEST(MergeExposures, MeasuredTimesBendsDustAndDarkMapsAreTakenOut) {
  SensorResponse response = kResponse;
  response.nonlinearity = 0.1;
  response.shutter = {{.nominal_s = 0.5, .true_s = 0.55, .sigma_s = 0}};
  response.maps.bias_dn = cv::Mat1f(10, 12, 520.0F);
  response.maps.dark_dn_per_s = cv::Mat1f(10, 12, 4.0F);
  response.maps.flat = cv::Mat1f(10, 12, 0.9F);
  const double level = (512 + 8000 - 520 - 2 - 1) / 15871.0;
  EXPECT_NEAR(merge_exposures({flat_picture(8000, 0.5)}, response, 1.0).radiance(3, 3),
              level * std::exp(0.1 * level) / 0.55 / 0.9, 1e-6);
}

TEST(MergeExposures, ABadPixelOnASlopeBecomesItsNeighboursMean) {
  for (const cv::Point bad : {cv::Point(6, 4), cv::Point(7, 4), cv::Point(7, 5), cv::Point(0, 5), cv::Point(11, 9)}) {
    SensorPicture raw = flat_picture(0, 1);
    for (int row = 0; row < 10; ++row)
      for (int column = 0; column < 12; ++column)
        raw.mosaic(row, column) = static_cast<ushort>(1512 + 40 * column + 24 * row);
    const double truth = (raw.mosaic(bad) - 512) / 15871.0;
    raw.mosaic(bad) = 16383;
    SensorResponse response = kResponse;
    response.maps.bad = cv::Mat1b(10, 12, uchar{0});
    response.maps.bad(bad) = 255;
    const LinearMosaic merged = merge_exposures({raw}, response);
    // Neighbours on one side alone, at the border, cannot know the slope: it is 40 to 100 DN to the next of its colour.
    const bool inside = bad.x > 1 && bad.x < 10 && bad.y > 1 && bad.y < 8;
    EXPECT_NEAR(merged.radiance(bad), truth, inside ? 1e-6 : 130 / 15871.0) << bad;
    EXPECT_EQ(merged.saturated(bad), 0);
  }
}

TEST(MergeExposures, BracketsThatDoNotBelongTogetherAreRefused) {
  const SensorPicture raw = flat_picture(1000, 0.1);
  EXPECT_THROW(merge_exposures({}, {}), std::runtime_error);
  EXPECT_THROW(merge_exposures({raw, flat_picture(1000, 0.1, {14, 10})}, {}), std::runtime_error);
  SensorPicture other = raw;
  other.iso = 200;
  EXPECT_THROW(merge_exposures({raw, other}, {}), std::runtime_error);
  SensorResponse response;
  response.maps.flat = cv::Mat1f(4, 4, 1.0F);
  EXPECT_THROW(merge_exposures({raw}, response), std::runtime_error);
}

TEST(MergeExposures, DevelopedVarianceIsTheSpreadOfDevelopedPixels) {
  simulated_sensor::Camera camera({}, 8, {}, {200, 160});
  camera.look_at([](double, double) { return 1.0; });
  SensorResponse response{.gain_dn_per_e = 15871 / 50000.0, .read_noise_e = 5};
  const Developed seen = develop({camera.photograph(0.1), camera.photograph(0.4)}, {.response = &response});
  cv::Scalar mean, deviation;
  cv::meanStdDev(seen.radiance(cv::Rect(2, 2, 196, 156)), mean, deviation);
  const cv::Scalar variance = cv::mean(seen.variance(cv::Rect(2, 2, 196, 156)));
  // Values at red and blue sites, between them and across are interpolated from one to four pixels, so variances differ
  // from pixel to pixel; their mean is the spread. The 30000 pixels share values, which leaves about 2 %.
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(deviation[c] * deviation[c] / variance[c], 1, 0.06) << c;
}

}  // namespace
}  // namespace calibration

#include "station/bench/exposure.h"

#include <gtest/gtest.h>

namespace station {
namespace {

calibration::SensorPicture flat_picture(double level, double exposure_s) {
  calibration::SensorPicture picture;
  picture.black_level_dn = 500;
  picture.white_level_dn = 16000;
  picture.exposure_s = exposure_s;
  const double dn = std::min(16000.0, 500 + 15500 * level);
  picture.mosaic = cv::Mat1w(40, 60, static_cast<std::uint16_t>(dn));
  return picture;
}

TEST(Exposure, AScenesExposureIsFoundInAFewTestPictures) {
  for (const double radiance : {0.001, 0.05, 1.0, 40.0, 900.0}) {
    double exposure_s = 0.125;
    int tests = 0;
    while (const auto next = next_exposure_s(flat_picture(radiance * exposure_s, exposure_s), {}, {})) {
      exposure_s = *next;
      ASSERT_LT(++tests, 7) << radiance;
    }
    const double level = radiance * exposure_s;
    EXPECT_GT(level, 0.6 / 1.51) << radiance;
    EXPECT_LT(level, 0.6 * 1.51) << radiance;
  }
}

TEST(Exposure, OnlyTheRegionCounts) {
  calibration::SensorPicture picture = flat_picture(0.1, 1);
  picture.mosaic(cv::Rect(0, 0, 30, 40)).setTo(15999);
  cv::Mat1b right(picture.mosaic.size(), static_cast<unsigned char>(0));
  right(cv::Rect(30, 0, 30, 40)).setTo(255);
  EXPECT_NEAR(bright_level(picture, right, 99.5), 0.1, 1e-3);
  EXPECT_GT(bright_level(picture, {}, 99.5), 0.99);
}

TEST(Exposure, ASaturatedPictureAsksForLessAndABlackOneForMore) {
  EXPECT_LT(*next_exposure_s(flat_picture(5, 1), {}, {}), 1.0);
  EXPECT_GT(*next_exposure_s(flat_picture(0, 1), {}, {}), 10.0);
}

}  // namespace
}  // namespace station

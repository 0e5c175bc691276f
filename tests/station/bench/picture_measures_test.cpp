// The figures of one picture, on pictures drawn for the purpose.
#include "station/bench/picture_measures.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <opencv2/imgproc.hpp>

namespace station {
namespace {

// Rows of threads 5 px apart with a little noise, seen through a lens that blurs.
cv::Mat1f threads(double blur_px) {
  cv::Mat1f picture(120, 160);
  for (int row = 0; row < picture.rows; ++row)
    picture.row(row).setTo(static_cast<float>(0.2 + 0.05 * std::cos(2 * std::numbers::pi * row / 5)));
  cv::RNG noise(3);
  for (float& pixel : picture) pixel += static_cast<float>(noise.gaussian(0.01));
  cv::GaussianBlur(picture, picture, {0, 0}, blur_px);
  return picture;
}

const cv::Mat1b& everywhere() {
  static const cv::Mat1b region(120, 160, uchar{255});
  return region;
}

TEST(Sharpness, FallsWithBlurAndNotWithLight) {
  const double sharp = sharpness(threads(0.7), everywhere());
  EXPECT_GT(sharp, 0);
  EXPECT_LT(sharpness(threads(1.4), everywhere()), 0.6 * sharp);
  EXPECT_LT(sharpness(threads(4), everywhere()), 0.2 * sharp);
  cv::Mat1f brighter;
  threads(0.7).convertTo(brighter, CV_32F, 7);
  EXPECT_NEAR(sharpness(brighter, everywhere()), sharp, 1e-4 * sharp);
}

// Glints and hot pixels are hundreds of times as bright as threads, and a blurred picture of them still has much
// contrast.
TEST(Sharpness, SparklesHaveNoSay) {
  for (const double blur_px : {0.7, 4.0}) {
    cv::Mat1f sparkling = threads(blur_px);
    cv::RNG places(5);
    for (int i = 0; i < 10; ++i) sparkling(places.uniform(0, 120), places.uniform(0, 160)) = 80.0F;
    const double without = sharpness(threads(blur_px), everywhere());
    EXPECT_NEAR(sharpness(sparkling, everywhere()), without, 0.15 * without) << "blur " << blur_px << " px";
  }
}

TEST(Sharpness, IsOfTheRegionAlone) {
  cv::Mat1f half_sharp = threads(4);
  threads(0.7).rowRange(0, 60).copyTo(half_sharp.rowRange(0, 60));
  cv::Mat1b upper(120, 160, uchar{0});
  upper.rowRange(10, 50).setTo(255);
  EXPECT_NEAR(sharpness(half_sharp, upper) / sharpness(threads(0.7), upper), 1, 0.02);
  EXPECT_EQ(sharpness(half_sharp, cv::Mat1b(120, 160, uchar{0})), 0);
}

}  // namespace
}  // namespace station

// A photograph against a rendering.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/core.hpp>

#include "station/output/compare/compare_pictures.h"
#include "tests/support/message_of.h"

namespace station {
namespace {

using testing::HasSubstr;

// Light that is strongest at one column, as on a cylinder.
cv::Mat3f cylinder(double peak_px, const cv::Vec3f& colour) {
  cv::Mat3f picture(96, 160);
  for (int row = 0; row < picture.rows; ++row)
    for (int column = 0; column < picture.cols; ++column)
      picture(row, column) = colour * static_cast<float>(0.1 + std::exp(-std::pow((column - peak_px) / 20, 2)));
  return picture;
}

const cv::Vec3f kBlue(0.1F, 0.2F, 0.6F);

TEST(Compare, APictureAgreesWithItselfAtAnyBrightness) {
  const cv::Mat3f photograph = cylinder(60, kBlue);
  const cv::Mat3f darker = cv::Mat(photograph * 0.25);
  const Comparison found = compare_pictures(photograph, darker, {}, {});
  EXPECT_NEAR(found.scale, 4, 1e-6);  // float
  EXPECT_LT(found.delta_e_95, 1e-3);
  EXPECT_LT(found.relative_rmse, 1e-6);
  EXPECT_NEAR(found.profile_correlation, 1, 1e-9);
  EXPECT_EQ(found.photograph.peak_px, found.rendering.peak_px);
  const Comparison same_unit = compare_pictures(photograph, darker, {}, {.fit_scale = false});
  EXPECT_EQ(same_unit.scale, 1);
  EXPECT_NEAR(same_unit.relative_rmse, 0.75, 1e-6);
}

// A path tracer's few samples: most pixels are dark, some are many times too bright, and their mean is right.
TEST(Compare, NoiseOfTheRenderingDoesNotMakeItDarker) {
  const cv::Mat3f photograph = cylinder(60, kBlue);
  cv::Mat3f noisy = photograph.clone();
  cv::RNG random(7);
  for (cv::Vec3f& pixel : noisy) pixel = random.uniform(0, 8) == 0 ? pixel * 8 : cv::Vec3f(0, 0, 0);
  const Comparison found = compare_pictures(photograph, noisy, {}, {.block_px = 32});
  EXPECT_NEAR(found.scale, 1,
              0.1);  // 15360 pixels, each with a standard deviation of 2.6: 0.02 and its share of the bright ones
  EXPECT_LT(found.mean_delta_e, 4);
}

TEST(Compare, AHighlightElsewhereAndAnotherColourAreMeasured) {
  const cv::Mat3f photograph = cylinder(60, kBlue);
  const Comparison moved = compare_pictures(photograph, cylinder(75, kBlue), {}, {});
  EXPECT_NEAR(moved.rendering.peak_px - moved.photograph.peak_px, 15, 1);  // a pixel
  EXPECT_LT(moved.profile_correlation, 0.9);
  const Comparison red = compare_pictures(photograph, cylinder(60, {0.6F, 0.2F, 0.1F}), {}, {});
  EXPECT_GT(red.mean_delta_e, 20);
  EXPECT_GT(red.profile_correlation, 0.999) << "the same highlight in another colour";
}

TEST(Compare, OnlyTheMaskCounts) {
  const cv::Mat3f photograph = cylinder(60, kBlue);
  cv::Mat3f rendering = photograph.clone();
  rendering(cv::Rect(0, 0, 160, 48)).setTo(cv::Scalar(1, 0, 0));
  cv::Mat1b mask(photograph.size(), static_cast<unsigned char>(0));
  mask(cv::Rect(0, 48, 160, 48)).setTo(255);
  EXPECT_LT(compare_pictures(photograph, rendering, mask, {}).mean_delta_e, 1e-3);
  EXPECT_GT(compare_pictures(photograph, rendering, {}, {}).mean_delta_e, 5);
  EXPECT_EQ(comparison_picture(photograph, rendering, mask, {}).size(), cv::Size(480, 96));
}

TEST(Compare, PicturesThatCannotBeComparedAreOneLine) {
  const cv::Mat3f photograph = cylinder(60, kBlue);
  const auto refusal = [&](const cv::Mat3f& rendering, const cv::Mat1b& mask) {
    return message_of([&] { compare_pictures(photograph, rendering, mask, {}); });
  };
  EXPECT_THAT(refusal(cv::Mat3f(10, 10), {}), HasSubstr("160 x 96"));
  EXPECT_THAT(refusal(photograph, cv::Mat1b(photograph.size(), static_cast<unsigned char>(0))), HasSubstr("empty"));
  EXPECT_THAT(refusal(cv::Mat3f(photograph.size(), cv::Vec3f(0, 0, 0)), {}), HasSubstr("no light"));
}

}  // namespace
}  // namespace station

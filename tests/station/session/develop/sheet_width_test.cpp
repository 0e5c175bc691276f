#include "station/session/develop/sheet_width.h"

#include <gtest/gtest.h>

#include <cmath>

namespace station {
namespace {

// 600 mm before the holder, threads across the picture.
renderer::Camera camera() {
  renderer::Camera camera{.width = 400, .height = 300, .fx = 2400, .fy = 2400, .cx = 199.5, .cy = 149.5};
  Eigen::Isometry3d holder_from_camera = Eigen::Isometry3d::Identity();
  holder_from_camera.linear() << 0, 0, -1, 1, 0, 0, 0, -1, 0;
  holder_from_camera.translation() = Eigen::Vector3d(600, 0, 0);
  camera.world_from_camera = holder_from_camera;
  return camera;
}

// A sheet of this width, its middle at `middle_mm`, pixels averaged.
cv::Mat3f picture(double width_mm, double middle_mm, float threads, float frame) {
  cv::Mat3f image(300, 400);
  for (int row = 0; row < image.rows; ++row) {
    constexpr int kSamples = 50;
    float sum = 0;
    for (int s = 0; s < kSamples; ++s) {
      const double z_mm = -(row + (s + 0.5) / kSamples - 0.5 - 149.5) * (600 - 0.25) / 2400;
      sum += std::abs(z_mm - middle_mm) < width_mm / 2 ? threads : frame;
    }
    image.row(row).setTo(cv::Scalar::all(static_cast<double>(sum) / kSamples));
  }
  return image;
}

TEST(SheetWidth, IsMeasuredToATenthOfAPixelWithBrightAndWithDarkThreads) {
  const inversion::WrappedSpool spool{.turns = 50, .thread_diameter_mm = 0.5};
  constexpr double kTenth_mm = 0.025;
  for (const double width_mm : {23.1, 24.6, 25.0, 26.3}) {
    const auto bright = sheet_width_mm(picture(width_mm, 0.2, 0.5F, 0.03F), camera(), spool);
    ASSERT_TRUE(bright.has_value());
    EXPECT_NEAR(*bright, width_mm, kTenth_mm);
    const auto dark = sheet_width_mm(picture(width_mm, -0.3, 0.01F, 0.03F), camera(), spool);
    ASSERT_TRUE(dark.has_value());
    EXPECT_NEAR(*dark, width_mm, kTenth_mm);
  }
}

TEST(SheetWidth, ThreadsAsDarkAsTheFrameOrOutOfThePictureGiveNone) {
  const inversion::WrappedSpool spool{.turns = 50, .thread_diameter_mm = 0.5};
  EXPECT_FALSE(sheet_width_mm(picture(25, 0, 0.031F, 0.03F), camera(), spool).has_value());
  renderer::Camera aside = camera();
  aside.cy += 120;
  EXPECT_FALSE(sheet_width_mm(picture(25, 0, 0.5F, 0.03F), aside, spool).has_value());
}

}  // namespace
}  // namespace station

// Which part of the cloth on the cylinder is compared.
#include "station/bench/cloth_on_cylinder.h"

#include <gtest/gtest.h>

#include <opencv2/imgproc.hpp>

namespace station {
namespace {

const renderer::CylinderShape kCylinder;
const Eigen::Vector3d kLight_mm(500, 350, 200);

// The same view with so many times as many pixels a side; pixel centres of the small one are those of blocks of the
// large one.
renderer::Camera camera(int times) {
  renderer::Camera seen = renderer::look_at({700, 0, 120}, {0, 0, 85}, {0, 0, 1});
  seen.width = 300 * times, seen.height = 260 * times;
  seen.fx = seen.fy = 800.0 * times;
  seen.cx = times * (149.5 + 0.5) - 0.5, seen.cy = times * (129.5 + 0.5) - 0.5;
  return seen;
}

TEST(LitSide, OfALargePictureIsThatOfASmallOneButForItsBorder) {
  const cv::Mat1b small = lit_side(kCylinder, camera(1), kLight_mm);
  ASSERT_GT(cv::countNonZero(small), 5000);
  constexpr int kTimes = 11;  // 3300 px: looked at in blocks of 4
  const cv::Mat1b large = lit_side(kCylinder, camera(kTimes), kLight_mm);
  cv::Mat1b inside, around;
  cv::erode(small, inside, cv::Mat1b::ones(3, 3));
  cv::dilate(small, around, cv::Mat1b::ones(3, 3));
  for (cv::Mat1b* one : {&inside, &around}) cv::resize(*one, *one, large.size(), 0, 0, cv::INTER_NEAREST);
  EXPECT_EQ(cv::countNonZero(inside & ~large), 0);
  EXPECT_EQ(cv::countNonZero(large & ~around), 0);
  EXPECT_NEAR(cv::countNonZero(large), kTimes * kTimes * cv::countNonZero(small),
              0.02 * kTimes * kTimes * cv::countNonZero(small));
}

TEST(LitSide, IsOnTheLampsSide) {
  const cv::Mat1b mask = lit_side(kCylinder, camera(1), kLight_mm);
  const cv::Mat1b other = lit_side(kCylinder, camera(1), {500, -350, 200});
  EXPECT_NE(cv::boundingRect(mask), cv::boundingRect(other));
  cv::Mat1b mirrored;
  cv::flip(other, mirrored, 1);
  EXPECT_LT(cv::countNonZero(mask != mirrored), 20);
}

}  // namespace
}  // namespace station

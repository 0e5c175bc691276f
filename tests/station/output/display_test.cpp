// Exposure by a white card: what is as bright as the card is the screen's white, in every picture.
#include "station/output/display.h"

#include <gtest/gtest.h>

#include <cmath>

namespace station {
namespace {

constexpr std::array<double, 9> kSrgb{1, 0, 0, 0, 1, 0, 0, 0, 1};
constexpr std::array<double, 3> kCard{0.02, 0.04, 0.01};  // a lamp that is green to the camera

// A picture of the card with this reflectance.
cv::Mat3f card(float reflectance) {
  return cv::Mat3f(10, 10, reflectance * cv::Vec3f(cv::Vec3d(kCard[0], kCard[1], kCard[2])));
}

TEST(Exposure, AWhiteCardIsWhiteAndAGreyOneGrey) {
  EXPECT_EQ(display(card(1), {.white = kCard}, kSrgb)(5, 5), cv::Vec3b(255, 255, 255));
  const cv::Vec3b grey = display(card(0.5F), {.white = kCard}, kSrgb)(5, 5);
  EXPECT_EQ(grey, cv::Vec3b(188, 188, 188));  // half of the light in sRGB
}

TEST(Exposure, AStopIsTwiceTheLight) {
  EXPECT_EQ(display(card(0.25F), {.white = kCard, .stops = 1}, kSrgb)(0, 0), cv::Vec3b(188, 188, 188));
  EXPECT_EQ(display(card(2), {.white = kCard, .stops = -2}, kSrgb)(0, 0), cv::Vec3b(188, 188, 188));
}

TEST(Exposure, TheStopsThatFitLeaveTheBrightestBelowWhite) {
  for (const float reflectance : {0.004F, 0.06F, 0.3F, 0.9F, 5.0F}) {
    const int stops = fitting_stops(card(reflectance), kCard);
    EXPECT_LT(reflectance * std::exp2(stops), 1) << reflectance;
    EXPECT_GT(reflectance * std::exp2(stops + 1), 0.8) << reflectance;
  }
  EXPECT_EQ(fitting_stops(cv::Mat3f(4, 4, cv::Vec3f(0, 0, 0)), kCard), 0) << "black";
}

TEST(Exposure, IsSaidInWords) {
  EXPECT_EQ(describe(Exposure{}), "a white card is white");
  EXPECT_EQ(describe(Exposure{.stops = -1}), "a white card is white, then 1 stop darker");
  EXPECT_EQ(describe(Exposure{.stops = 3}), "a white card is white, then 3 stops brighter");
}

}  // namespace
}  // namespace station

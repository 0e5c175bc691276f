#include "station/bench/metering.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "tests/station/bench/fake_exposure.h"
#include "tests/support/message_of.h"

namespace station {
namespace {

constexpr int kMost = 8;

Metering meter(FakeCamera& camera, double first_s, const ChooseExposure& choose = choose_fake_exposure) {
  return meter_exposure(camera, PlanStep{}, {.exposure_s = first_s, .iso = 100, .f_number = 8}, choose, kMost, [] {});
}

TEST(Metering, ConvergesFromTooDarkAndFromTooBright) {
  for (const double first_s : {0.001, 0.6, 30.0}) {
    for (const double radiance : {0.05, 1.0, 40.0}) {
      FakeCamera camera;
      camera.radiance = [=] { return radiance; };
      const Metering metering = meter(camera, first_s);
      EXPECT_TRUE(metering.converged);
      // The camera offers thirds of stops, and the choice is done within a third.
      EXPECT_LT(std::abs(std::log2(metering.settings.exposure_s * radiance / 0.6)), 0.34);
    }
  }
}

TEST(Metering, EndsAtTheLongestTimeThatTheCameraOffers) {
  FakeCamera camera;
  camera.radiance = [] { return 1e-6; };
  const Metering metering = meter(camera, 1.0);
  EXPECT_TRUE(metering.converged);
  EXPECT_EQ(metering.settings.exposure_s, camera.shutter_times_s().back());
}

TEST(Metering, SaysWhenTheChoiceNeverSettles) {
  FakeCamera camera;
  const Metering metering = meter(camera, 1.0, [](const PlanStep&, const rig::Picture& test) {
    return ExposureChoice{.exposure_s = test.settings.exposure_s > 0.5 ? 0.25 : 1.0, .done = false};
  });
  EXPECT_FALSE(metering.converged);
  EXPECT_EQ(metering.test_pictures, kMost);
}

TEST(Metering, RefusesAnExposureThatIsNoTime) {
  FakeCamera camera;
  const auto no_time = [](const PlanStep&, const rig::Picture&) {
    return ExposureChoice{.exposure_s = std::nan(""), .done = true};
  };
  EXPECT_THAT(message_of([&] { meter(camera, 1.0, no_time); }), testing::HasSubstr("metering asked for an exposure"));
}

TEST(Metering, ACameraThatDoesNotFollowIsAnErrorThatSaysBothSettings) {
  FakeCamera camera;
  camera.stuck_shutter = true;
  camera.now.exposure_s = 0.5;
  const std::string message = message_of([&] { set_camera(camera, {.exposure_s = 2, .iso = 100, .f_number = 8}); });
  EXPECT_THAT(message, testing::HasSubstr("asked for 2 s, ISO 100, f/8 and stands at 0.5 s"));
}

}  // namespace
}  // namespace station

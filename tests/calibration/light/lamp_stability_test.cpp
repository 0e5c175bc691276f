#include "calibration/light/lamp_stability.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>

#include "tests/calibration/sensor/simulated_sensor.h"

namespace calibration {
namespace {

struct Seen {
  LampStability lamp;
  simulated_sensor::Calibrated sensor;
};

Seen seen_with(const rig::LampChanges& changes, double exposure_s = 0.1) {
  simulated_sensor::Camera camera({}, 4, changes);
  Seen seen{.lamp = {}, .sensor = simulated_sensor::calibrate(camera)};
  const LevelBins bins = make_level_bins(camera.photograph(exposure_s), seen.sensor.darks.maps);
  std::vector<SensorPicture> rapid;
  for (int i = 0; i < 10; ++i) {
    camera.wait_s(0.0137);  // no whole number of the lamp's periods
    rapid.push_back(camera.photograph(exposure_s));
  }
  seen.lamp = lamp_stability(rapid, bins, seen.sensor.darks.maps, seen.sensor.ladder);
  return seen;
}

TEST(LampStability, ASteadyLampShowsNeitherFlickerNorDrift) {
  const LampStability lamp = seen_with({}).lamp;
  EXPECT_LT(lamp.flicker, 1e-4);  // 1e9 electrons: 3e-5
  EXPECT_LT(std::abs(lamp.drift_per_min), 5 * lamp.drift_sigma_per_min);
}

TEST(LampStability, DriftIsFoundFromTheSameExposuresTakenTwice) {
  const LampStability lamp = seen_with({.drift_per_s = -0.01 / 60}).lamp;
  std::printf("true -1 %% per minute: %.4f %% +- %.4f\n", 100 * lamp.drift_per_min, 100 * lamp.drift_sigma_per_min);
  EXPECT_NEAR(lamp.drift_per_min / -0.01, 1, 0.05);
  EXPECT_LT(lamp.flicker, 1e-4) << "a straight drift is no flicker";
}

TEST(LampStability, ASwitchedLampFlickersByWhatItsPeriodsLeave) {
  // Ten and a bit periods, half of one dark: the strength varies by up to 1 / 20 of its mean.
  const double flicker = seen_with({.pwm_hz = 103, .pwm_duty = 0.5}).lamp.flicker;
  std::printf("103 Hz at 1/10 s: %.3f %%\n", 100 * flicker);
  EXPECT_GT(flicker, 0.002);
  EXPECT_LT(flicker, 0.05);
  EXPECT_LT(seen_with({.pwm_hz = 20000, .pwm_duty = 0.5}).lamp.flicker, 0.002) << "2000 periods average out";
}

TEST(LampStability, ALampChangeOfTwoPercentIsAPauseAndOfTenAFailure) {
  const auto passed = [](const std::vector<double>& strength) {
    const std::vector<Gate> gates = lamp_gates(strength);
    return std::pair{gates.at(0).passed, gates.at(1).passed};
  };
  EXPECT_EQ(passed({1, 0.99, 0.98, 0.97}), (std::pair{true, true}));
  EXPECT_EQ(passed({1, 0.99, 0.965}), (std::pair{false, true}));
  EXPECT_EQ(passed({1, 0.985, 0.97, 0.955, 0.94, 0.925, 0.911, 0.895}), (std::pair{true, false}));
  EXPECT_EQ(passed({1}), (std::pair{true, true}));
  EXPECT_NE(lamp_gates({1, 0.9}).front().reason.find("10 %"), std::string::npos);
}

TEST(LampStability, TooFewOrDarkPicturesAreRefused) {
  simulated_sensor::Camera camera({}, 4);
  camera.look_at(simulated_sensor::white_panel);
  const LevelBins bins = make_level_bins(camera.photograph(0.1), {});
  std::vector<SensorPicture> rapid(9, camera.photograph(0.1));
  EXPECT_THROW(lamp_stability(rapid, bins, {}, {}), std::runtime_error);
  rapid.push_back(camera.photograph(0.8));  // saturated
  EXPECT_THROW(lamp_stability(rapid, bins, {}, {}), std::runtime_error);
}

}  // namespace
}  // namespace calibration

#include "rig/simulated/lamp_changes.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/rig/simulated/raw_reader.h"
#include "tests/rig/simulated/uniform_bench.h"

namespace {

double level(rig::Camera& camera, const rig::CameraSettings& settings) {
  camera.configure(settings);
  return cv::mean(read_raw(camera.capture().bytes).mosaic)[0] - 512;
}

rig::Arrangement lit(bool room_light) {
  return {.object = rig::BenchObject::spectralon, .lamp = rig::Lamp::front, .room_light = room_light};
}

}  // namespace

TEST(LampChanges, AConstantLampHasStrengthOneAtAllTimes) {
  for (const double begin_s : {0.0, 3.7, 1e5}) EXPECT_EQ(rig::lamp_strength({}, begin_s, 0.1), 1.0);
}

TEST(LampChanges, DriftCountsAtTheMiddleOfTheExposure) {
  EXPECT_NEAR(rig::lamp_strength({.drift_per_s = -0.001}, 10, 4), 1 - 0.012, 1e-15);
}

TEST(LampChanges, AJumpWithinAnExposureCountsForTheRestOfIt) {
  const rig::LampChanges out{.jump = -1, .jump_at_s = 10};
  EXPECT_EQ(rig::lamp_strength(out, 5, 1), 1.0);
  EXPECT_NEAR(rig::lamp_strength(out, 9, 4), 0.25, 1e-15);
  EXPECT_EQ(rig::lamp_strength(out, 10, 1), 0.0);
}

TEST(LampChanges, ASwitchedLampFlickersInShortExposuresAndKeepsItsMean) {
  const rig::LampChanges switched{.pwm_hz = 100, .pwm_duty = 0.25};
  EXPECT_NEAR(rig::lamp_strength(switched, 0, 0.0025), 4, 1e-9);     // within the bright quarter
  EXPECT_NEAR(rig::lamp_strength(switched, 0.003, 0.005), 0, 1e-9);  // within the dark rest
  EXPECT_NEAR(rig::lamp_strength(switched, 0.0012, 0.05), 1, 1e-9);  // five whole periods
  EXPECT_LT(std::abs(rig::lamp_strength(switched, 0.0012, 0.253) - 1), 0.75 / 25.3);
}

TEST(LampChanges, EverythingTheLampLightsDimsAlikeAndTheRoomLightStays) {
  rig::BenchTruth truth{.lamp_changes = {.jump = -0.5, .jump_at_s = 1}};
  UniformBench bench({0.4F, 0.4F, 0.4F}, truth);
  bench.bench.place(lit(false));
  const double before = level(*bench.camera, {.exposure_s = 0.5});
  bench.clock.sleep_s(10);
  const double after = level(*bench.camera, {.exposure_s = 0.5});
  EXPECT_NEAR(after / before, 0.5, 1e-3);  // 10000 electrons over 240000 pixels: 2e-5; the dark electron: 1e-4
  EXPECT_EQ(bench.drawings, 1) << "the strength needs no new drawing";
  // This bench draws the same brightness for the room's light alone.
  bench.bench.place(lit(true));
  EXPECT_NEAR(level(*bench.camera, {.exposure_s = 0.5}) / before, 1.5, 1e-3);
}

TEST(LampChanges, ALeakOfTheRoomLightShinesWhenItShouldBeOff) {
  rig::SimulatedBench bench({.room_radiance = {1, 2, 3}, .room_leak = 0.1},
                            [](const rig::BenchState&) { return cv::Mat3f(); });
  bench.place({});
  EXPECT_TRUE(bench.state().room_radiance.isApprox(Eigen::Vector3d(0.1, 0.2, 0.3)));
  bench.place({.room_light = true});
  EXPECT_TRUE(bench.state().room_radiance.isApprox(Eigen::Vector3d(1, 2, 3)));
}

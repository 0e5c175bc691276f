#include "rig/devices/clock.h"

#include <gtest/gtest.h>

#include <limits>

#include "rig/devices/camera.h"

TEST(SimulatedClock, StartsAtItsTimeAndSleepingAdvancesItAtOnce) {
  rig::SimulatedClock clock(1795256430.123);
  EXPECT_EQ(clock.utc(), "2026-11-21T10:20:30.123Z");
  EXPECT_EQ(clock.monotonic_s(), 0);
  clock.sleep_s(86400.5);
  EXPECT_EQ(clock.utc(), "2026-11-22T10:20:30.623Z");
  EXPECT_EQ(clock.monotonic_s(), 86400.5);
}

TEST(SystemClock, NeverRunsBackwardsAndWritesIso8601) {
  rig::SystemClock clock;
  const double before_s = clock.monotonic_s();
  clock.sleep_s(0);
  EXPECT_GE(clock.monotonic_s(), before_s);
  const std::string utc = clock.utc();
  ASSERT_EQ(utc.size(), 24U);
  EXPECT_EQ(utc[10], 'T');
  EXPECT_EQ(utc[19], '.');
  EXPECT_EQ(utc.back(), 'Z');
}

TEST(NearestShutter, IsNearestInStopsNotInSeconds) {
  // 0.6 s is 0.4 s from 1 s and 0.35 s from 0.25 s, but 0.74 of a stop from 1 s and 1.26 stops from 0.25 s.
  EXPECT_EQ(rig::nearest_shutter_s({0.25, 1.0}, 0.6), 1.0);
  EXPECT_EQ(rig::nearest_shutter_s({0.25, 1.0}, 0.3), 0.25);
  EXPECT_EQ(rig::nearest_shutter_s({0.25, 1.0}, 100), 1.0);
}

TEST(NearestShutter, RefusesTimesThatAreNotPositiveAndCamerasWithoutTimes) {
  EXPECT_THROW(rig::nearest_shutter_s({1.0}, 0), std::runtime_error);
  EXPECT_THROW(rig::nearest_shutter_s({1.0}, std::numeric_limits<double>::quiet_NaN()), std::runtime_error);
  EXPECT_THROW(rig::nearest_shutter_s({}, 1.0), std::runtime_error);
}

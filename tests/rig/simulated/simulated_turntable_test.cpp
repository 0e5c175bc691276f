#include <gtest/gtest.h>

#include <limits>

#include "rig/devices/degree.h"
#include "tests/rig/devices/eventful_clock.h"
#include "tests/rig/simulated/uniform_bench.h"

namespace {

using rig::kDegree;

struct TurningBench {
  explicit TurningBench(rig::TrueTurntable truth = {.scale = 1.002, .step_rad = 0.025 * kDegree, .speed_rad_s = 0.5})
      : bench({.turntable = truth}, [](const rig::BenchState& state) {
          return cv::Mat3f(state.lens.height_px, state.lens.width_px, cv::Vec3f::all(0.1F));
        }) {}
  double true_angle_rad() const { return bench.state().platform_angle_rad; }

  rig::SimulatedBench bench;
  EventfulClock clock;
  std::unique_ptr<rig::Turntable> table = rig::make_simulated_turntable(bench, clock);
};

}  // namespace

TEST(SimulatedTurntable, StandsAtTheNearestStepAndItsTrueAngleIsTheScaledReading) {
  TurningBench rig;
  rig.table->home();
  for (const double wanted_deg : {30.01, -77.7, 359.99, 0.0}) {
    rig.table->move_to(wanted_deg * kDegree);
    const double reading_rad = rig.table->angle_rad();
    const double steps = reading_rad / (0.025 * kDegree);
    EXPECT_NEAR(steps, std::round(steps), 1e-9);  // rounding of doubles
    EXPECT_NEAR(reading_rad, wanted_deg * kDegree, 0.0125 * kDegree + 1e-12);
    EXPECT_DOUBLE_EQ(rig.true_angle_rad(), 1.002 * reading_rad);
    EXPECT_EQ(rig.table->state(), rig::TurntableState::idle);
  }
}

TEST(SimulatedTurntable, ReachesEveryAngleWhenItHasNoSteps) {
  TurningBench rig({.scale = 1, .step_rad = 0, .speed_rad_s = 1});
  rig.table->home();
  rig.table->move_to(0.123456789);
  EXPECT_EQ(rig.table->angle_rad(), 0.123456789);
}

TEST(SimulatedTurntable, TakesTheTimeOfTheWay) {
  TurningBench rig({.scale = 1, .step_rad = 0, .speed_rad_s = 0.5});
  rig.table->home();
  EXPECT_EQ(rig.clock.monotonic_s(), 0);
  rig.table->move_to(1);
  EXPECT_NEAR(rig.clock.monotonic_s(), 2, 1e-9);  // a hundred slices, rounded
  rig.table->move_to(-0.5);
  EXPECT_NEAR(rig.clock.monotonic_s(), 5, 1e-9);
}

TEST(SimulatedTurntable, KnowsNoAngleUntilItIsHomed) {
  TurningBench rig;
  rig.bench.turn_platform(1.0);
  EXPECT_EQ(rig.table->state(), rig::TurntableState::unknown_position);
  EXPECT_THROW(rig.table->move_to(0.5), std::runtime_error);
  EXPECT_THROW(rig.table->angle_rad(), std::runtime_error);
  EXPECT_EQ(rig.true_angle_rad(), 1.0);
  rig.table->stop();
  EXPECT_EQ(rig.table->state(), rig::TurntableState::unknown_position);
  rig.table->home();
  EXPECT_EQ(rig.table->angle_rad(), 0);
  EXPECT_EQ(rig.true_angle_rad(), 0);
}

TEST(SimulatedTurntable, RefusesAnglesThatAreNoAnglesBeforeItMoves) {
  TurningBench rig;
  rig.table->home();
  rig.table->move_to(0.5);
  const double before_rad = rig.true_angle_rad(), before_s = rig.clock.monotonic_s();
  for (const double angle_rad : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity(),
                                 361 * kDegree, -361 * kDegree})
    EXPECT_THROW(rig.table->move_to(angle_rad), std::runtime_error);
  EXPECT_EQ(rig.true_angle_rad(), before_rad);
  EXPECT_EQ(rig.clock.monotonic_s(), before_s);
  EXPECT_EQ(rig.table->state(), rig::TurntableState::idle);
  EXPECT_NO_THROW(rig.table->move_to(360 * kDegree));
}

TEST(SimulatedTurntable, AStopEndsTheMoveWhereItIsAndTheNextMoveGoesOn) {
  TurningBench rig({.scale = 1.002, .step_rad = 0.025 * kDegree, .speed_rad_s = 0.5});
  rig.table->home();
  rig.clock.plan(1.0, [&] {
    EXPECT_EQ(rig.table->state(), rig::TurntableState::moving);
    rig.table->stop();
  });
  EXPECT_THROW(rig.table->move_to(90 * kDegree), std::runtime_error);
  EXPECT_EQ(rig.table->state(), rig::TurntableState::stopped);
  // Half a radian after a second; the stop is seen within a slice of 0.02 s, 0.01 rad.
  EXPECT_NEAR(rig.table->angle_rad(), 0.5, 0.011);
  EXPECT_DOUBLE_EQ(rig.true_angle_rad(), 1.002 * rig.table->angle_rad());
  rig.table->move_to(90 * kDegree);
  EXPECT_EQ(rig.table->state(), rig::TurntableState::idle);
  EXPECT_NEAR(rig.table->angle_rad(), 90 * kDegree, 0.0125 * kDegree + 1e-12);
}

TEST(SimulatedTurntable, AStopWhileHomingLeavesThePositionUnknown) {
  TurningBench rig;
  rig.bench.turn_platform(2.0);
  rig.clock.plan(1.0, [&] { rig.table->stop(); });
  EXPECT_THROW(rig.table->home(), std::runtime_error);
  EXPECT_EQ(rig.table->state(), rig::TurntableState::unknown_position);
  rig.table->home();
  EXPECT_EQ(rig.table->state(), rig::TurntableState::idle);
}

TEST(SimulatedTurntable, AStopWhileStandingKeepsThePosition) {
  TurningBench rig;
  rig.table->home();
  rig.table->move_to(0.5);
  const double reading_rad = rig.table->angle_rad();
  rig.table->stop();
  EXPECT_EQ(rig.table->state(), rig::TurntableState::stopped);
  EXPECT_EQ(rig.table->angle_rad(), reading_rad);
  EXPECT_NO_THROW(rig.table->move_to(0));
}

#include "rig/simulated/simulated_bench.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/rig/simulated/raw_reader.h"

namespace {

rig::Arrangement holder_on_platform() {
  rig::Arrangement wanted{.object = rig::BenchObject::holder, .on_platform = true, .lamp = rig::Lamp::front};
  wanted.pose.translation() = Eigen::Vector3d(10, 0, 80);
  return wanted;
}

rig::SimulatedBench bench_with(rig::BenchTruth truth) {
  return {truth, [](const rig::BenchState& state) {
            return cv::Mat3f(state.lens.height_px, state.lens.width_px, cv::Vec3f::all(0));
          }};
}

}  // namespace

TEST(SimulatedBench, WhatStandsOnThePlatformTurnsWithIt) {
  rig::SimulatedBench bench = bench_with({});
  bench.place(holder_on_platform());
  const Eigen::Isometry3d at_zero = bench.state().world_from_object;
  bench.turn_platform(0.7);
  const Eigen::Isometry3d expected = Eigen::AngleAxisd(0.7, Eigen::Vector3d::UnitZ()) * at_zero;
  EXPECT_TRUE(bench.state().world_from_object.isApprox(expected, 1e-14));
}

TEST(SimulatedBench, WhatIsHeldInTheHandDoesNotTurn) {
  rig::SimulatedBench bench = bench_with({});
  rig::Arrangement held = holder_on_platform();
  held.on_platform = false;
  bench.place(held);
  const Eigen::Isometry3d before = bench.state().world_from_object;
  bench.turn_platform(0.7);
  EXPECT_EQ(bench.state().world_from_object.matrix(), before.matrix());
}

TEST(SimulatedBench, AHandPlacesRoughlyAndTheSameEachTimeItIsAsked) {
  rig::SimulatedBench bench = bench_with({});
  const rig::Arrangement wanted = holder_on_platform();
  bench.place(wanted);
  const Eigen::Isometry3d placed = bench.state().world_from_object;
  EXPECT_GT((placed.translation() - wanted.pose.translation()).norm(), 0.01);

  rig::Arrangement vertical = wanted;
  vertical.mounting = rig::Mounting::vertical;
  bench.place(vertical);
  EXPECT_NE(bench.state().world_from_object.matrix(), placed.matrix());

  rig::Arrangement other_light = wanted;
  other_light.lamp = rig::Lamp::back;
  other_light.room_light = true;
  bench.place(other_light);
  EXPECT_EQ(bench.state().world_from_object.matrix(), placed.matrix());

  rig::SimulatedBench another_hand = bench_with({.seed = 2});
  another_hand.place(wanted);
  EXPECT_NE(another_hand.state().world_from_object.matrix(), placed.matrix());
}

TEST(SimulatedBench, AHandsErrorsHaveTheStandardDeviationsOfTheTruth) {
  rig::SimulatedBench bench = bench_with({.placement_mm = 2, .placement_rad = 0.03});
  constexpr int kPlacements = 2000;
  Eigen::Vector3d squares_mm2 = Eigen::Vector3d::Zero(), squares_rad2 = Eigen::Vector3d::Zero();
  for (int i = 0; i < kPlacements; ++i) {
    rig::Arrangement wanted = holder_on_platform();
    wanted.on_platform = false;
    wanted.pose.translation().x() = i;
    bench.place(wanted);
    const Eigen::Isometry3d wanted_from_placed = wanted.pose.inverse() * bench.state().world_from_object;
    const Eigen::AngleAxisd turn(wanted_from_placed.linear());
    squares_mm2 += wanted_from_placed.translation().cwiseAbs2();
    squares_rad2 += (turn.angle() * turn.axis()).cwiseAbs2();
  }
  for (int axis = 0; axis < 3; ++axis) {
    // Relative standard error of a deviation from 2000 numbers: 1 / sqrt(4000) = 1.6 %; five of them.
    EXPECT_NEAR(std::sqrt(squares_mm2[axis] / kPlacements) / 2, 1, 0.08);
    EXPECT_NEAR(std::sqrt(squares_rad2[axis] / kPlacements) / 0.03, 1, 0.08);
  }
}

TEST(SimulatedBench, WhatStandsOnThePlatformIsNeitherLiftedNorTilted) {
  rig::SimulatedBench bench = bench_with({.placement_mm = 2, .placement_rad = 0.03});
  const rig::Arrangement wanted = holder_on_platform();
  bench.place(wanted);
  const Eigen::Isometry3d placed = bench.state().world_from_object;
  EXPECT_EQ(placed.translation().z(), wanted.pose.translation().z());
  EXPECT_NEAR(placed.linear()(2, 2), 1, 1e-15);
  EXPECT_NE(placed.linear()(0, 1), 0);
}

TEST(SimulatedBench, TheLampStandsWhereTheOperatorPutItAndTheRoomLightIsOnWhenAsked) {
  rig::BenchTruth truth;
  truth.front = {.position = {500, 100, 300}, .intensity = {1, 2, 3}};
  truth.back = {.position = {-400, 0, 200}, .intensity = {4, 5, 6}};
  rig::SimulatedBench bench = bench_with(truth);
  const auto person = rig::make_simulated_operator(bench);
  EXPECT_FALSE(bench.state().lamp.has_value());
  EXPECT_EQ(bench.state().room_radiance, Eigen::Vector3d::Zero());

  person->arrange({.lamp = rig::Lamp::front});
  ASSERT_TRUE(bench.state().lamp.has_value());
  EXPECT_EQ(bench.state().lamp->position, truth.front.position);
  person->arrange({.lamp = rig::Lamp::back, .room_light = true});
  ASSERT_TRUE(bench.state().lamp.has_value());
  EXPECT_EQ(bench.state().lamp->intensity, truth.back.intensity);
  EXPECT_EQ(bench.state().room_radiance, truth.room_radiance);
}

TEST(SimulatedBench, TheDrawingIsToldEverythingThatIsTrueNow) {
  rig::BenchTruth truth;
  truth.lens.fx_px = 1234;
  truth.front.position = {500, 100, 300};
  std::optional<rig::BenchState> told;
  rig::SimulatedBench bench(truth, [&](const rig::BenchState& state) {
    told = state;
    return cv::Mat3f(state.lens.height_px, state.lens.width_px, cv::Vec3f::all(0));
  });
  bench.place(holder_on_platform());
  bench.turn_platform(0.3);
  bench.draw();
  ASSERT_TRUE(told.has_value());
  EXPECT_EQ(told->lens.fx_px, 1234);
  EXPECT_TRUE(rig::same_arrangement(told->arrangement, holder_on_platform()));
  EXPECT_EQ(told->platform_angle_rad, 0.3);
  EXPECT_EQ(told->lamp.value().position, truth.front.position);
  EXPECT_TRUE(rig::same_state(*told, bench.state()));
}

TEST(SimulatedBench, MovingThePlatformChangesThePicture) {
  rig::SimulatedBench bench({}, [](const rig::BenchState& state) {
    const auto bright = static_cast<float>(0.5 + 0.4 * state.world_from_object.linear()(0, 0));
    return cv::Mat3f(state.lens.height_px, state.lens.width_px, cv::Vec3f::all(bright));
  });
  rig::SimulatedClock clock(0);
  const auto camera = rig::make_simulated_camera(bench, clock);
  const auto table = rig::make_simulated_turntable(bench, clock);
  bench.place(holder_on_platform());
  camera->configure({.exposure_s = 1});
  table->home();
  const double facing = cv::mean(read_raw(camera->capture().bytes).mosaic)[0];
  table->move_to(1.5);
  const double sideways = cv::mean(read_raw(camera->capture().bytes).mosaic)[0];
  EXPECT_GT(facing - sideways, 0.3 * 15871);  // cos 0 - cos 1.5 rad = 0.93, times 0.4, less the hand's 0.01 rad
}

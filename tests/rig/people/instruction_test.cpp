#include <gtest/gtest.h>

#include "rig/people/operator.h"

namespace {

using rig::Arrangement, rig::BenchObject, rig::Lamp, rig::Mounting;

Arrangement holder(Mounting mounting, Lamp lamp = Lamp::front) {
  return {.object = BenchObject::holder, .mounting = mounting, .on_platform = true, .lamp = lamp};
}

Arrangement board_at(const Eigen::Vector3d& position_mm, const Eigen::Matrix3d& turn) {
  Arrangement wanted{.object = BenchObject::board, .room_light = true};
  // Facing the camera: the board's +z is the world's +x, its +y the world's +z.
  const Eigen::Matrix3d facing = (Eigen::Matrix3d() << 0, 0, 1, 1, 0, 0, 0, 1, 0).finished();
  wanted.pose.linear() = turn * facing;
  wanted.pose.translation() = position_mm;
  return wanted;
}

}  // namespace

TEST(SameArrangement, IsWhenAPersonHasNothingToDo) {
  EXPECT_TRUE(rig::same_arrangement(holder(Mounting::vertical), holder(Mounting::vertical)));
  EXPECT_FALSE(rig::same_arrangement(holder(Mounting::vertical), holder(Mounting::horizontal)));
  EXPECT_FALSE(rig::same_arrangement(holder(Mounting::vertical), holder(Mounting::vertical, Lamp::back)));
  EXPECT_FALSE(rig::same_arrangement({}, {.room_light = true}));
  EXPECT_FALSE(rig::same_arrangement({}, holder(Mounting::vertical, Lamp::off)));
  // Only the holder has a mounting, and nothing has no pose.
  EXPECT_TRUE(rig::same_arrangement({.object = BenchObject::board},
                                    {.object = BenchObject::board, .mounting = Mounting::vertical}));
  Arrangement nothing_there;
  nothing_there.pose.translation().x() = 5;
  nothing_there.on_platform = true;
  EXPECT_TRUE(rig::same_arrangement({}, nothing_there));
}

TEST(SameArrangement, CountsAPoseToAMillionth) {
  Arrangement moved = holder(Mounting::vertical);
  moved.pose.translation().x() += 1e-9;
  EXPECT_TRUE(rig::same_arrangement(moved, holder(Mounting::vertical)));
  moved.pose.translation().x() += 0.1;
  EXPECT_FALSE(rig::same_arrangement(moved, holder(Mounting::vertical)));
}

TEST(Instruction, SaysOneSentenceForEachDifference) {
  EXPECT_EQ(rig::instruction(holder(Mounting::horizontal), holder(Mounting::horizontal)), "");
  EXPECT_EQ(rig::instruction(holder(Mounting::horizontal), holder(Mounting::vertical)),
            "Turn the holder so that the threads are vertical.");
  EXPECT_EQ(rig::instruction(holder(Mounting::vertical), holder(Mounting::horizontal, Lamp::back)),
            "Turn the holder so that the threads are horizontal. Move the flashlight behind the platform.");
  EXPECT_EQ(rig::instruction({.room_light = true}, {.lamp = Lamp::front}),
            "Put the flashlight in front of the platform and switch it on. Switch the room light off.");
  EXPECT_EQ(rig::instruction({.lamp = Lamp::back}, {.room_light = true}),
            "Switch the flashlight off. Switch the room light on.");
  EXPECT_EQ(rig::instruction({.object = BenchObject::spectralon}, {}), "Take the Spectralon target away.");
}

TEST(Instruction, SaysWhereATargetIsHeldAndWhereItsFaceLooks) {
  const Arrangement straight = board_at({0, 0, 120}, Eigen::Matrix3d::Identity());
  EXPECT_EQ(rig::instruction({.room_light = true}, straight),
            "Hold the printed target 12.0 cm above the table, its face towards the camera.");
  // Positive about +z turns a face that looks along +x towards +y, which the camera has on its right.
  const Eigen::Matrix3d right = Eigen::AngleAxisd(0.5, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  EXPECT_EQ(
      rig::instruction(straight, board_at({31, -20, 120}, right)),
      "Hold the printed target 12.0 cm above the table, 3.1 cm in front of the platform's centre and 2.0 cm to the "
      "left of the platform's centre, its face turned 29 degrees to the right from the camera.");
  const Eigen::Matrix3d up = Eigen::AngleAxisd(-0.35, Eigen::Vector3d::UnitY()).toRotationMatrix();
  EXPECT_EQ(rig::instruction(straight, board_at({0, 0, 0}, up)),
            "Hold the printed target at the platform's centre, its face tilted 20 degrees upwards from the camera.");
}

TEST(Instruction, ExchangesOneObjectForAnother) {
  Arrangement spectralon{.object = BenchObject::spectralon, .on_platform = true, .lamp = Lamp::front};
  EXPECT_EQ(
      rig::instruction(holder(Mounting::vertical), spectralon),
      "Take the holder away. Stand the Spectralon target on the platform, at the platform's centre, its face up.");
  EXPECT_EQ(rig::instruction(spectralon, holder(Mounting::vertical)),
            "Take the Spectralon target away. Put the holder on the platform, its front towards the camera, with the "
            "threads vertical.");
}

TEST(Instruction, ATargetOnAStandIsPutDownRoughly) {
  Arrangement board{.object = BenchObject::board, .on_platform = true, .stand = 1, .room_light = true};
  EXPECT_EQ(rig::instruction({.room_light = true}, board),
            "Put the printed target on stand 1, in the middle of the platform, its face towards the camera; 3 cm or 15 "
            "degrees off do no harm.");
  Arrangement on_its_side = board;
  on_its_side.stand = 3;
  on_its_side.on_its_side = true;
  EXPECT_NE(rig::instruction(board, on_its_side).find("the printed target, on its side, on stand 3"),
            std::string::npos);
}

TEST(Instruction, WhatIsKeptMovingIsAskedForOnce) {
  Arrangement first{.object = BenchObject::spectralon, .kept_moving = true}, second = first;
  second.pose.translation() = Eigen::Vector3d(1, 2, 3);
  EXPECT_TRUE(rig::same_arrangement(first, second));
  EXPECT_EQ(rig::instruction(first, second), "");
  EXPECT_NE(rig::instruction({}, first).find("move it gently to and fro"), std::string::npos);
}

TEST(Instruction, InFullSaysEverything) {
  EXPECT_EQ(rig::full_instruction({}),
            "Take away whatever stands on the platform. Switch the flashlight off. Switch the room light off.");
  EXPECT_EQ(rig::full_instruction(holder(Mounting::horizontal)),
            "Put the holder on the platform, its front towards the camera, with the threads horizontal. "
            "Put the flashlight in front of the platform and switch it on. Switch the room light off.");
}

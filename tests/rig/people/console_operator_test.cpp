#include "rig/people/console_operator.h"

#include <gtest/gtest.h>

#include "rig/people/practice_operator.h"
#include "rig/simulated/simulated_bench.h"
#include "tests/rig/people/terminal.h"

namespace {

const rig::Arrangement kFront{.lamp = rig::Lamp::front};
const rig::Arrangement kBack{.lamp = rig::Lamp::back};

}  // namespace

TEST(ConsoleOperator, SaysEverythingFirstAndThenTheDifferences) {
  rig_test::Terminal terminal("\n\n");
  const auto person = rig::make_console_operator(*terminal.person);
  person->arrange(kFront);
  EXPECT_TRUE(terminal.out.str().starts_with(rig::full_instruction(kFront)));
  terminal.out.str("");
  person->arrange(kBack);
  EXPECT_TRUE(terminal.out.str().starts_with("Move the flashlight behind the platform.\n"));
}

TEST(ConsoleOperator, AsksNothingWhenNothingIsToBeDone) {
  rig_test::Terminal terminal("\n");
  const auto person = rig::make_console_operator(*terminal.person);
  person->arrange(kFront);
  terminal.out.str("");
  EXPECT_NO_THROW(person->arrange(kFront));
  EXPECT_EQ(terminal.out.str(), "");
}

TEST(ConsoleOperator, ThrowsWhenThePersonDeclinesAndSaysEverythingTheNextTime) {
  rig_test::Terminal terminal("\nq\n\n");
  const auto person = rig::make_console_operator(*terminal.person);
  person->arrange(kFront);
  EXPECT_THROW(person->arrange(kBack), std::runtime_error);
  terminal.out.str("");
  person->arrange(kBack);
  EXPECT_TRUE(terminal.out.str().starts_with(rig::full_instruction(kBack)));
}

TEST(PracticeOperator, AsksAndThenTheSimulatedHandDoesIt) {
  rig::SimulatedBench bench({}, [](const rig::BenchState&) { return cv::Mat3f(); });
  rig_test::Terminal terminal("\nq\n");
  const auto person =
      rig::make_practice_operator(rig::make_console_operator(*terminal.person), rig::make_simulated_operator(bench));
  person->arrange(kFront);
  EXPECT_TRUE(terminal.out.str().starts_with(rig::full_instruction(kFront)));
  EXPECT_EQ(bench.state().arrangement.lamp, rig::Lamp::front);
  EXPECT_THROW(person->arrange(kBack), std::runtime_error);
  EXPECT_EQ(bench.state().arrangement.lamp, rig::Lamp::front) << "who declines has changed nothing";
}

TEST(ConsoleOperator, ThrowsWhenNobodyIsThere) {
  rig_test::Terminal terminal("");
  EXPECT_THROW(rig::make_console_operator(*terminal.person)->arrange(kFront), std::runtime_error);
}

TEST(PracticeOperator, WhatStandsWronglyIsPutRightByTheHand) {
  rig::BenchTruth truth;
  truth.stand_placement_mm = 30;
  rig::SimulatedBench bench(truth, [](const rig::BenchState&) { return cv::Mat3f(); });
  rig_test::Terminal terminal("\n\nq\n");
  const auto person =
      rig::make_practice_operator(rig::make_console_operator(*terminal.person), rig::make_simulated_operator(bench));
  person->arrange({.object = rig::BenchObject::board, .on_platform = true, .stand = 1});
  const Eigen::Vector3d before = bench.state().world_from_object.translation();
  EXPECT_LE(before.head<2>().cwiseAbs().maxCoeff(), 30);
  EXPECT_EQ(before.z(), 0) << "it stands";
  terminal.out.str("");
  person->correct("It stands 9 cm too far to the right.");
  EXPECT_TRUE(terminal.out.str().starts_with("It stands 9 cm too far to the right."));
  const Eigen::Vector3d after = bench.state().world_from_object.translation();
  EXPECT_GT((after - before).norm(), 1) << "the hand puts it elsewhere";
  EXPECT_THROW(person->correct("Again."), std::runtime_error);
  EXPECT_EQ(bench.state().world_from_object.translation(), after);
}

TEST(PracticeOperator, NobodyPutsRightWhatAScriptArranges) {
  struct Script final : rig::Operator {
    void arrange(const rig::Arrangement& /*wanted*/) override {}
  } script;
  EXPECT_THROW(script.correct("It stands too far back."), std::runtime_error);
}

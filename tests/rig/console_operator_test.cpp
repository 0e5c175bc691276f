#include "rig/console_operator.h"

#include <gtest/gtest.h>

#include <sstream>

#include "rig/practice_operator.h"
#include "rig/simulated_bench.h"

namespace {

const rig::Arrangement kFront{.lamp = rig::Lamp::front};
const rig::Arrangement kBack{.lamp = rig::Lamp::back};

}  // namespace

TEST(ConsoleOperator, SaysEverythingFirstAndThenTheDifferences) {
  std::istringstream in("\n\n");
  std::ostringstream out;
  const auto person = rig::make_console_operator(in, out);
  person->arrange(kFront);
  EXPECT_TRUE(out.str().starts_with(rig::full_instruction(kFront)));
  out.str("");
  person->arrange(kBack);
  EXPECT_TRUE(out.str().starts_with("Move the flashlight behind the platform.\n"));
}

TEST(ConsoleOperator, AsksNothingWhenNothingIsToBeDone) {
  std::istringstream in("\n");
  std::ostringstream out;
  const auto person = rig::make_console_operator(in, out);
  person->arrange(kFront);
  out.str("");
  EXPECT_NO_THROW(person->arrange(kFront));
  EXPECT_EQ(out.str(), "");
}

TEST(ConsoleOperator, ThrowsWhenThePersonDeclinesAndSaysEverythingTheNextTime) {
  std::istringstream in("\nq\n\n");
  std::ostringstream out;
  const auto person = rig::make_console_operator(in, out);
  person->arrange(kFront);
  EXPECT_THROW(person->arrange(kBack), std::runtime_error);
  out.str("");
  person->arrange(kBack);
  EXPECT_TRUE(out.str().starts_with(rig::full_instruction(kBack)));
}

TEST(PracticeOperator, AsksAndThenTheSimulatedHandDoesIt) {
  rig::SimulatedBench bench({}, [](const rig::BenchState&) { return cv::Mat3f(); });
  std::istringstream in("\nq\n");
  std::ostringstream out;
  const auto person =
      rig::make_practice_operator(rig::make_console_operator(in, out), rig::make_simulated_operator(bench));
  person->arrange(kFront);
  EXPECT_TRUE(out.str().starts_with(rig::full_instruction(kFront)));
  EXPECT_EQ(bench.state().arrangement.lamp, rig::Lamp::front);
  EXPECT_THROW(person->arrange(kBack), std::runtime_error);
  EXPECT_EQ(bench.state().arrangement.lamp, rig::Lamp::front) << "who declines has changed nothing";
}

TEST(ConsoleOperator, ThrowsWhenNobodyIsThere) {
  std::istringstream in("");
  std::ostringstream out;
  EXPECT_THROW(rig::make_console_operator(in, out)->arrange(kFront), std::runtime_error);
}

#include "rig/people/manual_turntable.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "rig/devices/degree.h"
#include "rig/devices/device_contract.h"
#include "rig/people/practice_turntable.h"
#include "rig/simulated/simulated_bench.h"
#include "tests/rig/people/terminal.h"

namespace {

using rig::kDegree;
using testing::HasSubstr;

struct ManualTurntable : testing::Test {
  rig::Turntable& with(const std::string& answers) {
    terminal.emplace(answers);
    table = rig::make_manual_turntable(*terminal->person);
    return *table;
  }
  std::string refusal(double angle_rad) {
    try {
      table->move_to(angle_rad);
    } catch (const std::exception& error) {
      return error.what();
    }
    return "(accepted)";
  }
  std::optional<rig_test::Terminal> terminal;
  std::unique_ptr<rig::Turntable> table;
};

}  // namespace

TEST_F(ManualTurntable, KeepsTheContractOfTurntablesWhenThePersonConfirms) {
  for (const rig::ContractRow& row : rig::check_turntable(with(std::string(100, '\n')), kDegree / 2, false))
    EXPECT_TRUE(row.passed) << row.name << ": " << row.what;
}

TEST_F(ManualTurntable, SaysWhereToTurnAndReadsWhatIsTyped) {
  with("\n 30,2 \n");
  table->home();
  EXPECT_THAT(terminal->out.str(), HasSubstr("until its mark is in front"));
  table->move_to(30 * kDegree);
  EXPECT_THAT(terminal->out.str(),
              HasSubstr("Turn the platform to 30.0 deg (counter-clockwise seen from above is more)."));
  EXPECT_NEAR(table->angle_rad(), 30.2 * kDegree, 1e-12);
}

TEST_F(ManualTurntable, AsksAgainUntilTheAngleIsTheOneAskedAndThenGivesUp) {
  with("\n20\nthirty\n30\n10\n11\n12\n");
  table->home();
  table->move_to(30 * kDegree);
  EXPECT_THAT(terminal->out.str(), HasSubstr("That is not 30.0 deg; turn it on."));
  EXPECT_THAT(terminal->out.str(), HasSubstr("That is no angle in degrees."));
  EXPECT_EQ(table->angle_rad(), 30 * kDegree);
  EXPECT_THAT(refusal(60 * kDegree), HasSubstr("no such angle was read three times"));
}

TEST_F(ManualTurntable, EndsWhenThePersonDeclinesOrIsNotThere) {
  with("\nq\n");
  table->home();
  EXPECT_THAT(refusal(0.5), HasSubstr("declined"));
  EXPECT_THAT(refusal(0.5), HasSubstr("run it at a terminal"));
  EXPECT_EQ(table->angle_rad(), 0);
}

TEST_F(ManualTurntable, RefusesAnglesThatAreNoneAndAsksNobody) {
  with("\n");
  table->home();
  const std::string before = terminal->out.str();
  EXPECT_THAT(refusal(7), HasSubstr("between -360 and 360"));
  EXPECT_THAT(refusal(std::nan("")), HasSubstr("between -360 and 360"));
  EXPECT_EQ(terminal->out.str(), before);
}

TEST_F(ManualTurntable, OnASimulatedBenchThePlatformStandsWhereThePersonSaysThatItDoes) {
  rig::SimulatedBench bench({.turntable = {.scale = 1.01}}, [](const rig::BenchState&) { return cv::Mat3f(); });
  rig::SimulatedClock clock(0);
  terminal.emplace("\n30.2\nq\n");
  table = rig::make_practice_turntable(rig::make_manual_turntable(*terminal->person),
                                       rig::make_simulated_turntable(bench, clock));
  table->home();
  table->move_to(30 * kDegree);
  EXPECT_NEAR(table->angle_rad(), 30.2 * kDegree, 1e-12);
  EXPECT_NEAR(bench.state().platform_angle_rad, 1.01 * 30.2 * kDegree, 1e-9);
  EXPECT_THAT(refusal(60 * kDegree), HasSubstr("declined"));
  EXPECT_NEAR(bench.state().platform_angle_rad, 1.01 * 30.2 * kDegree, 1e-9) << "who declines has changed nothing";
}

#include "rig/manual_turntable.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <sstream>

#include "rig/device_contract.h"

namespace {

using testing::HasSubstr;

constexpr double kDegree = std::numbers::pi / 180;

struct ManualTurntable : testing::Test {
  rig::Turntable& with(const std::string& answers) {
    in.str(answers);
    table = rig::make_manual_turntable(in, out);
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
  std::istringstream in;
  std::ostringstream out;
  std::unique_ptr<rig::Turntable> table;
};

}  // namespace

TEST_F(ManualTurntable, KeepsTheContractOfTurntablesWhenThePersonConfirms) {
  for (const rig::ContractRow& row : rig::check_turntable(with(std::string(100, '\n')), kDegree / 2)) {
    EXPECT_TRUE(row.passed) << row.name << ": " << row.what;
  }
}

TEST_F(ManualTurntable, SaysWhereToTurnAndReadsWhatIsTyped) {
  with("\n 30,2 \n");
  table->home();
  EXPECT_THAT(out.str(), HasSubstr("until its mark is in front"));
  table->move_to(30 * kDegree);
  EXPECT_THAT(out.str(), HasSubstr("Turn the platform to 30.0 deg (counter-clockwise seen from above is more)."));
  EXPECT_NEAR(table->angle_rad(), 30.2 * kDegree, 1e-12);
}

TEST_F(ManualTurntable, AsksAgainUntilTheAngleIsTheOneAskedAndThenGivesUp) {
  with("\n20\nthirty\n30\n10\n11\n12\n");
  table->home();
  table->move_to(30 * kDegree);
  EXPECT_THAT(out.str(), HasSubstr("That is not 30.0 deg; turn it on."));
  EXPECT_THAT(out.str(), HasSubstr("That is no angle in degrees."));
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
  const std::string before = out.str();
  EXPECT_THAT(refusal(7), HasSubstr("between -360 and 360"));
  EXPECT_THAT(refusal(std::nan("")), HasSubstr("between -360 and 360"));
  EXPECT_EQ(out.str(), before);
}

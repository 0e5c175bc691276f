// What a guided calibration asks of a person: few things, none of them to the millimetre, and no pose twice.
#include "station/bench/calibrate/calibration_plan.h"

#include <gtest/gtest.h>

#include <set>

#include "rig/people/operator.h"
#include "station/documents/degree.h"
#include "tests/places.h"

namespace station {
namespace {

const std::string kRigs = std::string(DATA_DIR) + "/rigs/";

struct CalibrationPlan : testing::TestWithParam<std::string> {
  RigFile rig = read_rig(kRigs + GetParam() + ".json");
  std::vector<CalibrationStep> plan = make_calibration_plan(rig);
};

TEST_P(CalibrationPlan, AsksForTwelveActionsAtMost) {
  const std::vector<int> actions = actions_of(plan);
  EXPECT_EQ(actions.front(), 1);
  EXPECT_LE(actions.back(), 12);
}

TEST_P(CalibrationPlan, NothingIsPlacedByTheRuler) {
  rig::Arrangement before;
  for (const CalibrationStep& step : plan) {
    const std::string asked = rig::instruction(before, step.arrangement);
    EXPECT_EQ(asked.find("cm above the table"), std::string::npos) << asked;
    EXPECT_EQ(asked.find("Hold"), asked.find("Hold the Spectralon target close before the lens")) << asked;
    EXPECT_EQ(step.follows_target, step.arrangement.stand > 0 && step.role != CalibrationRole::dark) << step.id;
    before = step.arrangement;
  }
}

TEST_P(CalibrationPlan, NoPoseComesTwice) {
  std::set<std::string> ids;
  std::set<std::tuple<int, int, bool, bool, long>> poses;
  int turned = 0, if_needed = 0;
  for (const CalibrationStep& step : plan) {
    EXPECT_TRUE(ids.insert(step.id).second) << step.id;
    const bool light = step.role == CalibrationRole::front_light || step.role == CalibrationRole::back_light;
    if (!light && step.role != CalibrationRole::lens) continue;
    ++(step.if_needed ? if_needed : turned);
    EXPECT_TRUE(
        poses
            .insert({static_cast<int>(step.role), step.arrangement.stand, step.arrangement.on_its_side,
                     step.arrangement.lamp == rig::Lamp::front, std::lround(step.platform_angle_rad / kDegree * 100)})
            .second)
        << step.id;
  }
  // A person who turns the platform by hand turns it sixty times at most.
  const bool by_hand = rig.turntable_driver == "manual";
  if (by_hand)
    EXPECT_LE(turned + if_needed + 9, 60);
  else
    EXPECT_LE(turned, 3 * 16 + 4 * 10);
  EXPECT_LE(if_needed, 16);
}

TEST_P(CalibrationPlan, ThePlatformIsNotTurnedFurtherThanItMay) {
  const double limit = rig.turntable_wire ? rig.turntable_wire->stepper.limit_rad : 180 * kDegree;
  for (const CalibrationStep& step : plan) EXPECT_LE(std::abs(step.platform_angle_rad), limit + 1e-9) << step.id;
}

INSTANTIATE_TEST_SUITE_P(ReadyRigs, CalibrationPlan,
                         testing::Values("simulated", "simulated_wire_grbl", "simulated_wire_zaber", "grbl_sony_usb",
                                         "grbl_sony_network", "zaber_sony_usb", "manual_sony_usb"),
                         [](const auto& of_rig) { return of_rig.param; });

}  // namespace
}  // namespace station

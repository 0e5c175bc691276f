#include "station/documents/plan.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include "station/documents/plan_file.h"
#include "tests/places.h"
#include "tests/station/documents/small_plan.h"
#include "tests/support/message_of.h"
#include "tests/support/temporary_folder.h"

namespace station {
namespace {

using testing::HasSubstr;

template <typename Is>
auto count(const Plan& plan, const Is& is) {
  return std::count_if(plan.steps.begin(), plan.steps.end(), is);
}

// The problem of a plan in which one step was changed.
std::string problem_after(const std::string& id, const std::function<void(PlanStep&)>& change) {
  Plan plan = make_capture_plan({});
  for (PlanStep& step : plan.steps)
    if (step.id == id) change(step);
  return check_plan(plan).value_or("");
}

TEST(Plan, HasTwelveReflectionsFiveTransmissionsAndADarkForEach) {
  const Plan plan = make_capture_plan({});
  EXPECT_EQ(count(plan, is_reflection), 12);
  EXPECT_EQ(count(plan, is_transmission), 5);
  EXPECT_EQ(view_count(plan), 17U);
  for (const PlanStep& step : plan.steps) {
    if (step.kind == StepKind::view) {
      const PlanStep* dark = find_step(plan, "dark-" + step.id);
      ASSERT_NE(dark, nullptr) << step.id;
      EXPECT_EQ(dark->exposure_of, step.id);
    }
  }
}

TEST(Plan, ABracketsExposuresFollowTheirViewUnderTheSameLight) {
  const Plan plan = make_capture_plan({.bracket_stops = {-2, 1.5}});
  EXPECT_EQ(view_count(plan), 17U);
  EXPECT_EQ(count(plan, [](const PlanStep& step) { return step.kind == StepKind::bracket; }), 34);
  EXPECT_EQ(count(plan, [](const PlanStep& step) { return step.kind == StepKind::dark; }), 17);
  for (std::size_t i = 0; i < plan.steps.size(); ++i) {
    const PlanStep& view = plan.steps[i];
    if (view.kind != StepKind::view) continue;
    for (const std::size_t next : {i + 1, i + 2}) {
      PlanStep exposure = plan.steps.at(next);
      EXPECT_EQ(exposure.exposure_of, view.id);
      EXPECT_EQ(exposure.stops, next == i + 1 ? -2 : 1.5);
      exposure.id = view.id;
      exposure.kind = view.kind;
      exposure.exposure_of = {};
      exposure.stops = 0;
      exposure.verify = view.verify;  // its view has been looked at
      EXPECT_EQ(exposure, view);
    }
  }
  EXPECT_NE(find_step(plan, "bracket-transmission-2-plus-1_5"), nullptr);
  EXPECT_EQ(plan_from_json(plan_to_json(plan), "plan"), plan);
  EXPECT_THROW(make_capture_plan({.bracket_stops = {0}}), std::runtime_error);
  EXPECT_THROW(make_capture_plan({.bracket_stops = {-2, -2}}), std::runtime_error);  // one id twice
}

TEST(Plan, TurnsTheHolderOnceAndMovesTheLampTwice) {
  const Plan plan = make_capture_plan({});
  int turned = 0, moved = 0;
  rig::Lamp lamp = rig::Lamp::front;
  for (std::size_t i = 1; i < plan.steps.size(); ++i) {
    turned += plan.steps[i].mounting != plan.steps[i - 1].mounting ? 1 : 0;
    if (plan.steps[i].kind == StepKind::view && plan.steps[i].lamp != lamp) {
      lamp = plan.steps[i].lamp;
      ++moved;
    }
  }
  EXPECT_EQ(turned, 1);
  EXPECT_EQ(moved, 2);
}

TEST(Plan, ComesBackFromItsDocument) {
  const Plan plan = make_capture_plan({});
  const Plan read = plan_from_json(nlohmann::json::parse(plan_to_json(plan).dump()), "plan.json");
  ASSERT_EQ(read.steps.size(), plan.steps.size());
  for (std::size_t i = 0; i < plan.steps.size(); ++i) {
    PlanStep step = read.steps[i];
    // Degrees are kept to a billionth.
    EXPECT_NEAR(step.platform_angle_rad, plan.steps[i].platform_angle_rad, 1e-10);
    step.platform_angle_rad = plan.steps[i].platform_angle_rad;
    EXPECT_EQ(step, plan.steps[i]);
  }
  EXPECT_EQ(plan_to_json(read), plan_to_json(plan)) << "a second trip changes nothing";
}

TEST(Plan, UsesTheAnglesThatWereGiven) {
  PlanRequest request;
  request.reflection_angles_deg = {-60, -40, -20, 20, 40, 60};
  const Plan plan = make_capture_plan(request);
  EXPECT_NEAR(find_step(plan, "reflection-vertical-6")->platform_angle_rad, std::numbers::pi / 3, 1e-12);
}

TEST(Plan, OfAnyOtherNumberOfAnglesIsRefused) {
  PlanRequest request;
  request.transmission_angles_deg.pop_back();
  EXPECT_THAT(message_of([&] { make_capture_plan(request); }), HasSubstr("5 transmission angles, 4 were given"));
}

TEST(Plan, SaysInOneLineWhatIsWrongWithAStep) {
  EXPECT_THAT(problem_after("transmission-2", [](PlanStep& s) { s.id = "transmission-1"; }), HasSubstr("stands twice"));
  EXPECT_THAT(problem_after("transmission-2", [](PlanStep& s) { s.id = "../x"; }), HasSubstr("'../x'"));
  EXPECT_THAT(problem_after("transmission-2", [](PlanStep& s) { s.platform_angle_rad = 4; }), HasSubstr("229.18"));
  EXPECT_THAT(problem_after("transmission-2",
                            [](PlanStep& s) { s.platform_angle_rad = std::numeric_limits<double>::quiet_NaN(); }),
              HasSubstr("finite"));
  EXPECT_THAT(problem_after("dark-transmission-2", [](PlanStep& s) { s.exposure_of = "nobody"; }),
              HasSubstr("'nobody' names no view"));
  EXPECT_THAT(problem_after("transmission-2", [](PlanStep& s) { s.exposure_of = "transmission-1"; }),
              HasSubstr("only a dark"));
  EXPECT_THAT(problem_after("transmission-2", [](PlanStep& s) { s.room_light = true; }), HasSubstr("room light off"));
  EXPECT_THAT(problem_after("dark-transmission-2", [](PlanStep& s) { s.lamp = rig::Lamp::front; }),
              HasSubstr("lamp and the room light off"));
  EXPECT_THAT(problem_after("reflection-horizontal-1", [](PlanStep& s) { s.mounting = rig::Mounting::vertical; }),
              HasSubstr("a pose picture with its mounting"));
  EXPECT_THAT(check_plan(Plan{}).value_or(""), HasSubstr("no view"));
}

TEST(Plan, AnUnknownKeyIsAnErrorThatNamesTheKeyAndTheFile) {
  nlohmann::json document = plan_to_json(small_plan());
  document["steps"][2]["colour"] = "red";
  const std::string message = message_of([&] { plan_from_json(document, "my-plan.json"); });
  EXPECT_THAT(message, HasSubstr("my-plan.json"));
  EXPECT_THAT(message, HasSubstr("colour"));
}

TEST(Plan, TakesLongerWithMoreSteps) {
  EXPECT_GT(estimated_duration_s(make_capture_plan({})), estimated_duration_s(small_plan()));
  EXPECT_GT(estimated_duration_s(small_plan()), 0);
}

TEST(Plan, SaysWhatEachPictureMustBeVerifiedForAndOthersAreRefusedWithoutHardware) {
  const Plan plan = make_capture_plan({.bracket_stops = {-2}, .reference_chip = true});
  for (const PlanStep& step : plan.steps) EXPECT_FALSE(step.verify.empty()) << step.id;
  EXPECT_THAT(find_step(plan, "pose-vertical-1")->verify, testing::Contains("tags"));
  EXPECT_THAT(find_step(plan, "transmission-2")->verify, testing::Contains("lamp"));
  EXPECT_EQ(plan_from_json(plan_to_json(plan), "plan.json"), plan);
  const std::string unknown = problem_after("transmission-2", [](PlanStep& step) {
    step.verify = {"focus", "orientation"};
  });
  EXPECT_THAT(unknown, HasSubstr("'transmission-2'"));
  EXPECT_THAT(unknown, HasSubstr("verify names 'orientation'"));
  EXPECT_THAT(unknown, HasSubstr("lamp_side")) << "what there is instead";
  nlohmann::json document = plan_to_json(plan);
  document["steps"][0]["verify"] = "tags";
  EXPECT_THAT(message_of([&] { plan_from_json(document, "plan.json"); }), HasSubstr("verify"));
}

TEST(Plan, TheDocumentedPlanIsReadAndWrittenAlike) {
  const std::string file = std::string(DATA_DIR) + "/plans/seventeen_views.json";
  const nlohmann::json document = nlohmann::json::parse(text_of(file));
  const Plan plan = plan_from_json(document, file);
  EXPECT_EQ(view_count(plan), 17U);
  EXPECT_EQ(plan_to_json(plan), document);
}

TEST(Plan, AViewMayHaveAnExposureOfItsOwnAndAPlanMayHaveNoPoseAtAll) {
  Plan plan = make_capture_plan({});
  std::erase_if(plan.steps, [](const PlanStep& step) { return step.kind == StepKind::pose; });
  plan.steps.front().exposure_s = 0.25;
  EXPECT_EQ(check_plan(plan), std::nullopt) << "pictures taken by hand";
  EXPECT_EQ(plan_from_json(plan_to_json(plan), "plan"), plan);
  plan.steps.front().exposure_s = -1;
  EXPECT_THAT(check_plan(plan).value_or(""), HasSubstr("exposure_s"));
  plan.steps.front().exposure_s.reset();
  plan.steps.back().exposure_s = 1;
  EXPECT_THAT(check_plan(plan).value_or(""), HasSubstr("exposure_s")) << "a dark has its view's";
}

}  // namespace
}  // namespace station

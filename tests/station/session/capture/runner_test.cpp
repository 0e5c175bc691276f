#include "station/session/capture/runner.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "station/bench/bench_fault.h"
#include "station/session/record/verify.h"
#include "tests/station/session/capture/runner_test.h"

namespace station {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

Verdict bad_verdict(const std::string& check, const std::string& reason, bool may_pass_again = false) {
  return {.findings = {{.check = check,
                        .grade = Grade::bad,
                        .value = std::nullopt,
                        .reason = reason,
                        .may_pass_again = may_pass_again}}};
}

TEST_F(RunnerTest, TakesThe17ViewsAndEveryOtherStepOfThePlan) {
  const Plan plan = make_capture_plan({});
  EXPECT_EQ(fake.run(path, plan), RunState::complete);
  const auto pictures = pictures_of(path);
  ASSERT_EQ(pictures.size(), plan.steps.size());
  for (const PlanStep& step : plan.steps) {
    const PictureRecord& picture = pictures.at(step.id);
    EXPECT_EQ(picture.kind, step.kind);
    if (picture.same_as.empty()) {
      EXPECT_EQ(picture.file, "raw/" + step.id + ".arw");
      EXPECT_EQ(picture.lamp, step.lamp);
      // Files carry degrees to a billionth.
      EXPECT_NEAR(picture.read_angle_rad, step.platform_angle_rad, 1e-10);
    }
  }
  EXPECT_EQ(last_outcome(), "complete");
  EXPECT_EQ(verify_session(path).views, 17U);
}

TEST_F(RunnerTest, TakesOneDarkForEachExposureOnly) {
  const Plan plan = make_capture_plan({});
  fake.run(path, plan);
  std::map<double, int> taken;
  for (const auto& [step, picture] : pictures_of(path)) {
    if (picture.kind == StepKind::dark) {
      EXPECT_EQ(picture.asked.exposure_s, pictures_of(path).at(find_step(plan, step)->exposure_of).asked.exposure_s);
      taken[picture.asked.exposure_s] += picture.same_as.empty() ? 1 : 0;
    }
  }
  EXPECT_EQ(taken.size(), 2U) << "lamp in front and lamp behind";
  for (const auto& [exposure_s, count] : taken) EXPECT_EQ(count, 1) << exposure_s;
}

TEST_F(RunnerTest, AsksThePersonOnlyForChanges) {
  fake.run(path, make_capture_plan({}));
  // pose, lamp in front, lamp behind, turned and lit for the pose, lamp in front, dark
  EXPECT_EQ(fake.person.asked.size(), 6U);
  for (const rig::Arrangement& arrangement : fake.person.asked) {
    EXPECT_EQ(arrangement.object, rig::BenchObject::holder);
    EXPECT_TRUE(arrangement.on_platform);
    EXPECT_EQ(arrangement.pose.translation().z(), arrangement.mounting == rig::Mounting::horizontal ? 60 : 80);
  }
}

TEST_F(RunnerTest, ReportsProgressUpToTheEnd) {
  std::vector<Progress> reports;
  fake.options.progress = [&](const Progress& progress) { reports.push_back(progress); };
  fake.options.choose_exposure = [this](const PlanStep&, const rig::Picture& test) {
    fake.clock.sleep_s(10);  // each metered step takes this long
    return ExposureChoice{.exposure_s = test.settings.exposure_s, .done = true};
  };
  fake.run(path, small_plan());
  ASSERT_EQ(reports.size(), 8U);
  for (std::size_t i = 0; i < reports.size(); ++i) {
    EXPECT_EQ(reports[i].done, i);
    EXPECT_EQ(reports[i].total, 7U);
  }
  EXPECT_EQ(reports.front().step, "pose-horizontal-1");
  EXPECT_GT(reports.front().seconds_left, 0) << "a guess before anything was measured";
  EXPECT_NEAR(reports[2].seconds_left, 5 * 10, 1e-9) << "five steps left, of the median duration";
  EXPECT_EQ(reports.back().seconds_left, 0);
}

TEST_F(RunnerTest, PausedAtAnyMomentItStopsThePlatformAndResumes) {
  const Plan plan = small_plan();
  bool interrupted = true;
  for (int at = 1; interrupted; ++at) {
    ASSERT_LT(at, 1000);
    const fs::path session = folder.session(at);
    FakeStation run;
    int asked = 0;
    run.options.stop_wish = [&] { return ++asked == at ? StopWish::pause : StopWish::none; };
    interrupted = run.run(session, plan) == RunState::paused;
    const JournalRecord last = records_of(session).back();
    ASSERT_EQ(last.event, "stop");
    EXPECT_EQ(last.data.at("outcome"), interrupted ? "paused" : "complete");
    EXPECT_EQ(run.turntable.stops, interrupted ? 1 : 0);
    const auto before = pictures_of(session);
    FakeStation fresh;
    EXPECT_EQ(fresh.run(session, plan), RunState::complete);
    EXPECT_EQ(count_events(session, "picture"), plan.steps.size()) << "nothing was taken twice";
    for (const auto& [step, picture] : before) EXPECT_EQ(pictures_of(session).at(step).sha256, picture.sha256);
    EXPECT_TRUE(verify_session(session).sound());
  }
}

TEST_F(RunnerTest, AMoveThatCtrlCEndedIsAnInterruptionAndNoFailure) {
  bool stop_asked = false;
  fake.options.choose_exposure = [&](const PlanStep&, const rig::Picture&) -> ExposureChoice {
    stop_asked = true;
    throw std::runtime_error("the platform was stopped on its way");
  };
  fake.options.stop_wish = [&] { return stop_asked ? StopWish::pause : StopWish::none; };
  EXPECT_EQ(fake.run(path, small_plan()), RunState::paused);
  EXPECT_EQ(last_outcome(), "paused");
}

TEST_F(RunnerTest, AFailedDeviceStopsThePlatformIsJournalledAndTheSessionResumes) {
  const Plan plan = small_plan();
  for (int at = 1;; ++at) {
    path = folder.session(at);
    FakeStation run;
    run.camera.fail_at_capture = at;
    const std::string message = message_of([&] { run.run(path, plan); });
    if (message.empty()) {
      EXPECT_GT(at, 7) << "each step has a picture";
      break;
    }
    EXPECT_THAT(message, HasSubstr("did not answer"));
    EXPECT_EQ(run.turntable.stops, 1);
    EXPECT_EQ(last_outcome(), "suspended");
    EXPECT_EQ(records_of(path).back().data.at("message"), message);
    expect_resume_completes(plan);
  }
}

TEST_F(RunnerTest, APlatformThatReadsAnotherAngleIsAnError) {
  fake.turntable.slips = true;
  EXPECT_THAT(message_of([&] { fake.run(path, small_plan()); }),
              HasSubstr("asked to turn to -35.0 deg and reads -32.1 deg"));
  EXPECT_EQ(count_events(path, "picture"), 0U);
  EXPECT_THROW(fake.run(path, small_plan()), BenchFault);
}

TEST_F(RunnerTest, ACameraThatKeepsItsSettingsIsAFaultOfTheBench) {
  fake.camera.stuck_shutter = true;
  fake.camera.now.exposure_s = 8;
  EXPECT_THROW(fake.run(path, small_plan()), BenchFault);
}

TEST_F(RunnerTest, APictureThatDoesNotServeIsAFaultOfTheBenchOnlyWhereItShowsThatTheBenchMoved) {
  for (const char* check : {"angle", "bench", "exposure", "focus", "lamp", "orientation", "tags"}) {
    fake.options.inspect = [&](const PlanStep&, const rig::Picture&, double) { return bad_verdict(check, "bad"); };
    bool bench = false;
    try {
      fake.run(path, small_plan());
    } catch (const BenchFault&) {
      bench = true;
    } catch (const std::runtime_error&) {
    }
    EXPECT_EQ(bench, check == std::string("angle") || check == std::string("bench")) << check;
  }
}

TEST_F(RunnerTest, AStalePictureOfTheCameraIsRefused) {
  fake.options.choose_exposure = nullptr;
  fake.camera.stale = true;
  EXPECT_THAT(message_of([&] { fake.run(path, small_plan()); }),
              HasSubstr("delivered the picture of 'pose-horizontal-1' again"));
  EXPECT_EQ(count_events(path, "picture"), 1U);
  expect_resume_completes(small_plan());
}

TEST_F(RunnerTest, AnEmptyPictureIsRefused) {
  fake.options.choose_exposure = nullptr;
  fake.camera.empty = true;
  EXPECT_THAT(message_of([&] { fake.run(path, small_plan()); }), HasSubstr("empty picture"));
}

TEST_F(RunnerTest, APictureTakenWithOtherSettingsIsRefused) {
  fake.options.choose_exposure = nullptr;
  fake.camera.lies = true;
  EXPECT_THAT(message_of([&] { fake.run(path, small_plan()); }), HasSubstr("was to be taken with 0.25 s"));
  EXPECT_TRUE(fs::is_empty(path / "raw"));
}

TEST_F(RunnerTest, ResumesOnlyWithItsOwnPlanAndCamera) {
  fake.options.stop_wish = [&] { return fake.camera.captures > 3 ? StopWish::pause : StopWish::none; };
  ASSERT_EQ(fake.run(path, small_plan()), RunState::paused);
  Plan other = small_plan();
  other.steps[1].platform_angle_rad += 0.1;
  FakeStation fresh;
  EXPECT_THAT(message_of([&] { fresh.run(path, other); }), HasSubstr("started with another plan"));
  fresh.camera.serial = "456";
  EXPECT_THAT(message_of([&] { fresh.run(path, small_plan()); }), HasSubstr("begun with the camera 123 and 456"));
  expect_resume_completes(small_plan());
}

TEST_F(RunnerTest, ACompleteSessionTouchesNoDeviceWhenResumed) {
  fake.run(path, small_plan());
  FakeStation fresh;
  EXPECT_EQ(fresh.run(path, small_plan()), RunState::complete);
  EXPECT_EQ(fresh.camera.captures, 0);
  EXPECT_FALSE(fresh.turntable.homed);
  EXPECT_TRUE(fresh.person.asked.empty());
}

TEST_F(RunnerTest, TakesAgainWhatWasDamagedOrLostAndWhatNobodyNamed) {
  fake.run(path, small_plan());
  const auto before = pictures_of(path);
  write_text(path / "raw/reflection-horizontal-1.arw", "damaged");
  fs::remove(path / "raw/dark-reflection-horizontal-1.arw");  // the second dark shares it
  write_text(path / "raw/stranger.arw", "?");
  expect_resume_completes(small_plan());
  EXPECT_FALSE(fs::exists(path / "raw/stranger.arw"));
  EXPECT_EQ(count_events(path, "discarded"), 3U);
  const auto after = pictures_of(path);
  EXPECT_NE(after.at("reflection-horizontal-1").sha256, before.at("reflection-horizontal-1").sha256);
  EXPECT_NE(after.at("dark-reflection-horizontal-2").sha256, before.at("dark-reflection-horizontal-2").sha256);
  for (const char* kept : {"pose-horizontal-1", "reflection-horizontal-2", "transmission-1", "dark-transmission-1"})
    EXPECT_EQ(after.at(kept).sha256, before.at(kept).sha256) << kept;
}

TEST_F(RunnerTest, WhatWasDiscardedCountsAsNotTakenUntilItIsTakenAgain) {
  fake.run(path, small_plan());
  fs::remove(path / "raw/transmission-1.arw");
  FakeStation stopped;
  stopped.options.stop_wish = [] { return StopWish::pause; };
  EXPECT_EQ(stopped.run(path, small_plan()), RunState::paused);
  EXPECT_FALSE(pictures_of(path).contains("transmission-1"));
  expect_resume_completes(small_plan());
  EXPECT_EQ(count_events(path, "discarded"), 1U);
}

TEST_F(RunnerTest, ABracketsExposureIsItsViewsTimeSoManyStopsLongerAndIsTakenAgainWithIt) {
  const Plan plan = make_capture_plan({.bracket_stops = {-2}});
  fake.run(path, plan);
  fs::remove(path / "raw/reflection-horizontal-1.arw");
  FakeStation dimmer;
  dimmer.camera.radiance = [] { return 0.05; };
  EXPECT_EQ(dimmer.run(path, plan), RunState::complete);
  const auto pictures = pictures_of(path);
  for (const PlanStep& step : plan.steps) {
    if (step.kind == StepKind::bracket) {
      const double ratio = pictures.at(step.id).asked.exposure_s / pictures.at(step.exposure_of).asked.exposure_s;
      EXPECT_NEAR(std::log2(ratio), -2, 1.0 / 6) << step.id;
    }
  }
  EXPECT_NE(pictures.at("reflection-horizontal-1").asked.exposure_s,
            pictures.at("reflection-horizontal-2").asked.exposure_s)
      << "the view was metered anew";
  EXPECT_TRUE(verify_session(path).sound());
}

TEST_F(RunnerTest, APictureThatDoesNotShowWhatThePlanWantsVerifiedIsRefused) {
  Plan plan = small_plan();
  for (PlanStep& step : plan.steps) step.verify = {"settings"};
  plan.steps[1].verify = {"settings", "lamp"};
  bool shows_the_lamp = false;
  fake.options.inspect = [&](const PlanStep&, const rig::Picture&, double) {
    Verdict verdict{.findings = {{.check = "settings", .grade = Grade::good, .value = 0, .reason = {}}}};
    if (shows_the_lamp) verdict.findings.push_back({.check = "lamp", .grade = Grade::good, .value = 100, .reason = {}});
    return verdict;
  };
  const std::string message = message_of([&] { fake.run(path, plan); });
  EXPECT_THAT(message, HasSubstr("'reflection-horizontal-1' is to be verified for 'lamp'"));
  EXPECT_EQ(pictures_of(path).size(), 1U);
  EXPECT_EQ(last_outcome(), "suspended");
  shows_the_lamp = true;
  EXPECT_EQ(fake.run(path, plan), RunState::complete);
}

TEST_F(RunnerTest, AnExposureThatTheRangeDoesNotNeedIsLeftOutAndTheSessionIsComplete) {
  const Plan plan = make_capture_plan({.bracket_stops = {-2, 2}, .brackets_if_needed = true});
  fake.options.inspect = [](const PlanStep& step, const rig::Picture&, double) {
    Verdict verdict;
    const auto found = [&](const char* check, double value) {
      verdict.findings.push_back({.check = check, .grade = Grade::good, .value = value, .reason = {}});
    };
    for (const char* check : {"settings", "tags", "exposure", "focus"}) found(check, 1);
    found("saturation", step.id == "reflection-horizontal-2" ? 0.2 : 0.0);
    found("shadows", step.id == "transmission-1" ? 0.5 : 5.0);
    return verdict;
  };
  EXPECT_EQ(fake.run(path, plan), RunState::complete);
  const auto pictures = pictures_of(path);
  std::vector<std::string> exposures;
  for (const auto& [step, picture] : pictures)
    if (picture.kind == StepKind::bracket) exposures.push_back(step);
  EXPECT_THAT(exposures,
              testing::ElementsAre("bracket-reflection-horizontal-2-minus-2", "bracket-transmission-1-plus-2"));
  const VerifyReport report = verify_session(path);
  EXPECT_THAT(report.problems, testing::IsEmpty());
  EXPECT_TRUE(report.complete);
}

TEST_F(RunnerTest, APictureThatDoesNotServeIsNotKeptAndTakenAgainByResume) {
  fake.options.inspect = [](const PlanStep& step, const rig::Picture&, double) {
    return step.id == "transmission-1" ? bad_verdict("lamp", "the lamp is off") : Verdict{};
  };
  EXPECT_THROW(fake.run(path, small_plan()), std::runtime_error);
  EXPECT_EQ(last_outcome(), "suspended");
  EXPECT_FALSE(fs::exists(path / "raw/transmission-1.arw"));
  EXPECT_FALSE(pictures_of(path).contains("transmission-1"));
  expect_resume_completes(small_plan());
}

TEST_F(RunnerTest, AViewTakenAgainAtAnotherExposureGetsItsOwnDark) {
  fake.run(path, small_plan());
  fs::remove(path / "raw/reflection-horizontal-1.arw");
  FakeStation dimmer;
  dimmer.camera.radiance = [] { return 0.1; };
  EXPECT_EQ(dimmer.run(path, small_plan()), RunState::complete);
  const auto pictures = pictures_of(path);
  for (const auto& [step, picture] : pictures) {
    if (picture.kind == StepKind::dark) {
      const std::string view = find_step(small_plan(), step)->exposure_of;
      EXPECT_EQ(picture.asked.exposure_s, pictures.at(view).asked.exposure_s) << step;
    }
  }
  EXPECT_TRUE(verify_session(path).sound());
}

// The stop comes at every poll in turn.
TEST_F(RunnerTest, ARunThatIsPausedOrAbortedIsNeverComplete) {
  for (const StopWish wish : {StopWish::pause, StopWish::now}) {
    RunState state = RunState::running;
    int at = 0;
    while (state != RunState::complete) {
      const fs::path session = folder.session(++at + (wish == StopWish::now ? 1000 : 0));
      FakeStation run;
      int asked = 0;
      run.options.stop_wish = [&] { return ++asked >= at ? wish : StopWish::none; };
      state = run.run(session, small_plan());
      if (state != RunState::complete) {
        EXPECT_EQ(state, wish == StopWish::pause ? RunState::paused : RunState::aborted);
        EXPECT_EQ(state_of(records_of(session), false), state);
        EXPECT_FALSE(verify_session(session).complete);
      }
    }
    EXPECT_GT(at, 20) << "polls of a session";
  }
}

TEST_F(RunnerTest, TheStopIsOnTheDiskBeforeThePlatformIsStoppedAndDevicesAreLeft) {
  fake.options.stop_wish = [&] { return fake.camera.captures > 3 ? StopWish::now : StopWish::none; };
  std::string seen;
  fake.turntable.on_stop = [&] { seen = last_outcome(); };
  EXPECT_EQ(fake.run(path, small_plan()), RunState::aborted);
  EXPECT_EQ(seen, "aborted");
}

TEST_F(RunnerTest, AfterTheLastRecordOfAStopAtOnceNothingIsAppended) {
  SessionFolder session = fake.create(path, small_plan());
  session.append("start", {{"files", nlohmann::json::object()}});
  session.append_last("stop", {{"outcome", "aborted"}});
  EXPECT_THAT(message_of([&] { session.append("picture", {}); }), HasSubstr("stop at once"));
  EXPECT_EQ(records_of(path).size(), 2U);
}

// Row 18: the camera answers one picture late, with the test picture that came before.
TEST_F(RunnerTest, ALatePictureOfTheCameraIsRefusedKeptAsideAndTakenAgain) {
  int judged = 0;
  fake.options.judged = [&](const PlanStep&, const Verdict& verdict) {
    ++judged;
    if (verdict.grade() == Grade::bad) {
      EXPECT_THAT(verdict.reason(), HasSubstr("test or refused picture"));
      fake.camera.late_at = 0;
    }
  };
  fake.camera.late_at = 3;  // after two tests for the first step
  EXPECT_EQ(fake.run(path, small_plan()), RunState::complete);
  EXPECT_EQ(count_events(path, "refused"), 1U);
  EXPECT_EQ(std::distance(fs::directory_iterator(path / "refused"), fs::directory_iterator()), 1);
  EXPECT_TRUE(verify_session(path).sound());
}

TEST_F(RunnerTest, APictureThatMayPassIsTakenAgainThreeTimesAndThenAPersonIsAsked) {
  fake.options.inspect = [](const PlanStep& step, const rig::Picture&, double) {
    return step.id == "transmission-1" ? bad_verdict("motion", "it moved", true) : Verdict{};
  };
  EXPECT_THAT(message_of([&] { fake.run(path, small_plan()); }), HasSubstr("it moved"));
  EXPECT_EQ(count_events(path, "refused"), 3U);
  EXPECT_EQ(last_outcome(), "suspended");
  expect_resume_completes(small_plan());
}

TEST_F(RunnerTest, OneViewIsTakenAgainOnRequestAndTheOthersStay) {
  fake.run(path, small_plan());
  const auto before = pictures_of(path);
  FakeStation again;
  again.options.reshoot = {"reflection-horizontal-2"};
  EXPECT_EQ(again.run(path, small_plan()), RunState::complete);
  const auto after = pictures_of(path);
  for (const auto& [step, picture] : before)
    EXPECT_EQ(after.at(step).sha256 == picture.sha256, step != "reflection-horizontal-2") << step;
  EXPECT_TRUE(fs::exists(path / "refused/reflection-horizontal-2-1.arw")) << "the first one is kept aside";
  EXPECT_TRUE(verify_session(path).sound());
  FakeStation wrong;
  wrong.options.reshoot = {"reflection-99"};
  EXPECT_THAT(message_of([&] { wrong.run(path, small_plan()); }), HasSubstr("no step of the plan"));
}

// The platform is found to have slipped: what was taken since a picture showed where it stood is doubted.
TEST_F(RunnerTest, ViewsStayApprovedOnlyIfTheFaultCouldNotHaveTouchedThem) {
  const auto inspect = [](bool slipped) {
    return [slipped](const PlanStep& step, const rig::Picture&, double) {
      if (step.id == "transmission-1" && slipped) return bad_verdict("angle", "the platform slipped");
      Verdict verdict;
      if (step.id == "reflection-horizontal-1")
        verdict.findings.push_back({.check = "angle", .grade = Grade::good, .value = 0.1, .reason = {}});
      return verdict;
    };
  };
  fake.options.inspect = inspect(true);
  EXPECT_THAT(message_of([&] { fake.run(path, small_plan()); }), HasSubstr("slipped"));
  const auto left = pictures_of(path);
  EXPECT_TRUE(left.contains("pose-horizontal-1"));
  EXPECT_TRUE(left.contains("reflection-horizontal-1")) << "its own tags said where it stood";
  EXPECT_FALSE(left.contains("reflection-horizontal-2")) << "nothing says that it had not slipped yet";
  FakeStation fresh;
  fresh.options.inspect = inspect(false);
  EXPECT_EQ(fresh.run(path, small_plan()), RunState::complete);
}

// The platform's tags in each picture tell where it really stands.
Verdict seen_by_tags(const FakeTurntable& turntable) {
  const bool off = std::abs(turntable.off_rad) > 0.5 * kDegree;
  Verdict verdict;
  verdict.findings.push_back({.check = "angle",
                              .grade = off ? Grade::bad : Grade::good,
                              .value = turntable.off_rad / kDegree,
                              .reason = off ? "the platform slipped" : ""});
  return verdict;
}

TEST_F(RunnerTest, APlatformThatStandsElsewhereFromTheBeginningIsSetRightByItsTags) {
  fake.turntable.off_rad = 45 * kDegree;
  fake.options.inspect = [&](const PlanStep&, const rig::Picture&, double) { return seen_by_tags(fake.turntable); };
  std::vector<double> asked_deg;
  fake.options.settle_place = [&](double reading_rad, double differ_rad) {
    asked_deg.push_back(differ_rad / kDegree);
    return std::optional(reading_rad + differ_rad);
  };
  EXPECT_EQ(fake.run(path, small_plan()), RunState::complete);
  ASSERT_EQ(asked_deg.size(), 1U) << "one question, at the first picture";
  EXPECT_NEAR(asked_deg[0], 45, 1e-9);
  EXPECT_NEAR(fake.turntable.off_rad, 0, 1e-12);
}

TEST_F(RunnerTest, APlatformWhoseTagsAreNotBelievedEndsTheRun) {
  fake.turntable.off_rad = 45 * kDegree;
  int pictures = 0;
  fake.options.inspect = [&](const PlanStep&, const rig::Picture&, double) {
    ++pictures;
    return seen_by_tags(fake.turntable);
  };
  fake.options.settle_place = [](double, double) { return std::optional<double>(); };
  EXPECT_THAT(message_of([&] { fake.run(path, small_plan()); }), HasSubstr("slipped"));
  EXPECT_EQ(pictures, 1) << "nothing is photographed on a platform that nobody knows";
}

TEST_F(RunnerTest, APlatformThatSlipsLaterHasSlippedWhateverAnybodySays) {
  int pictures = 0;
  fake.options.inspect = [&](const PlanStep&, const rig::Picture&, double) {
    if (++pictures == 3) fake.turntable.off_rad = 45 * kDegree;
    return seen_by_tags(fake.turntable);
  };
  fake.options.settle_place = [](double reading_rad, double differ_rad) {
    return std::optional(reading_rad + differ_rad);
  };
  EXPECT_THAT(message_of([&] { fake.run(path, small_plan()); }), HasSubstr("slipped"));
}

TEST_F(RunnerTest, TheStateOfASessionIsToldByItsJournal) {
  EXPECT_EQ(state_of({}, false), RunState::idle);
  fake.options.stop_wish = [&] { return fake.camera.captures > 3 ? StopWish::pause : StopWish::none; };
  fake.run(path, small_plan());
  auto records = records_of(path);
  EXPECT_EQ(state_of(records, false), RunState::paused);
  records.pop_back();
  EXPECT_EQ(state_of(records, true), RunState::running);
  EXPECT_EQ(state_of(records, false), RunState::interrupted) << "no stop, and nobody holds it";
  expect_resume_completes(small_plan());
  EXPECT_EQ(state_of(records_of(path), false), RunState::complete);
}

}  // namespace
}  // namespace station

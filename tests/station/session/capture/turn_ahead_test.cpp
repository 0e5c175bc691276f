// Sessions whose platform turns to the next view while the picture of this one is looked at.
#include "station/session/capture/turn_ahead.h"

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <mutex>

#include "station/session/capture/runner.h"
#include "tests/station/session/capture/runner_test.h"

namespace station {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

const std::string kFirst = "reflection-horizontal-1", kSecond = "reflection-horizontal-2";

struct TurningAhead : RunnerTest {
  TurningAhead() {
    fake.options.turn_ahead = true;
    fake.turntable.on_move = [this](double angle_rad) {
      {
        const std::lock_guard hold(mutex);
        angles_rad.push_back(angle_rad);
      }
      moved.notify_all();
      if (on_way) on_way(angle_rad);
    };
  }
  double angle_of(const std::string& step) const { return find_step(plan, step)->platform_angle_rad; }

  // True at once when the platform has been sent there; false when nothing of that kind happens.
  bool sent_to(const std::string& step) {
    std::unique_lock hold(mutex);
    return moved.wait_for(hold, std::chrono::seconds(10),
                          [&] { return !angles_rad.empty() && angles_rad.back() == angle_of(step); });
  }
  // Called when the first view's picture is looked at.
  void when_first_is_looked_at(const std::function<Verdict()>& work) {
    fake.options.inspect = [work](const PlanStep& step, const rig::Picture&, double) {
      return step.id == kFirst ? work() : Verdict();
    };
  }

  const Plan plan = small_plan();
  std::mutex mutex;
  std::condition_variable moved;
  std::vector<double> angles_rad;
  std::function<void(double)> on_way;
};

TEST_F(TurningAhead, ThePlatformIsOnItsWayWhileThePictureIsLookedAt) {
  bool on_its_way = false;
  when_first_is_looked_at([&] {
    on_its_way = sent_to(kSecond);
    return Verdict();
  });
  EXPECT_EQ(fake.run(path, plan), RunState::complete);
  EXPECT_TRUE(on_its_way);
  EXPECT_NEAR(pictures_of(path).at(kFirst).read_angle_rad, angle_of(kFirst), 1e-10);
  EXPECT_NEAR(pictures_of(path).at(kSecond).read_angle_rad, angle_of(kSecond), 1e-10);
  EXPECT_TRUE(verify_session(path).complete);
}

TEST_F(TurningAhead, ARejectedViewTurnsBack) {
  int looked_at = 0;
  when_first_is_looked_at([&] {
    sent_to(kSecond);
    Verdict verdict;
    if (++looked_at == 1)
      verdict.findings.push_back(
          {.check = "x", .grade = Grade::bad, .value = {}, .reason = "again", .may_pass_again = true});
    return verdict;
  });
  EXPECT_EQ(fake.run(path, plan), RunState::complete);
  const double first = angle_of(kFirst), second = angle_of(kSecond);
  ASSERT_GE(angles_rad.size(), 5U);
  EXPECT_THAT(std::vector(angles_rad.begin() + 1, angles_rad.begin() + 5), ElementsAre(first, second, first, second));
  EXPECT_NEAR(pictures_of(path).at(kFirst).read_angle_rad, first, 1e-10);
}

TEST_F(TurningAhead, WaitsWhereSomebodyHasToChangeSomethingFirst) {
  std::size_t moves = 0;
  fake.options.judged = [&](const PlanStep& step, const Verdict&) {
    const std::lock_guard hold(mutex);
    if (step.id == kSecond) moves = angles_rad.size();
  };
  fake.run(path, plan);
  EXPECT_EQ(moves, 3U) << "pose and two views: the lamp goes behind the holder before the platform turns on";
}

TEST_F(TurningAhead, TheJournalIsTheSameAsWithout) {
  const auto events = [&](bool ahead, const std::string& name) {
    FakeStation station;
    station.options.turn_ahead = ahead;
    EXPECT_EQ(station.run(folder / name, plan), RunState::complete);
    std::vector<std::string> found;
    for (const JournalRecord& record : records_of(folder / name))
      found.push_back(record.event + " " + record.data.value("step", std::string()));
    return found;
  };
  EXPECT_EQ(events(true, "ahead"), events(false, "one-after-the-other"));
}

TEST_F(TurningAhead, WhatFailsOnTheWayIsSaidWhenThePictureIsKept) {
  on_way = [&](double angle_rad) {
    if (angle_rad == angle_of(kSecond)) throw std::runtime_error("the turntable was unplugged");
  };
  EXPECT_THAT(message_of([&] { fake.run(path, plan); }), HasSubstr("was unplugged"));
  EXPECT_EQ(last_outcome(), "suspended");
  EXPECT_TRUE(pictures_of(path).contains(kFirst));
  expect_resume_completes(plan);
}

TEST_F(TurningAhead, MayBePausedOnTheWay) {
  bool wished = false;
  when_first_is_looked_at([&] {
    sent_to(kSecond);
    wished = true;
    return Verdict();
  });
  fake.options.stop_wish = [&] { return wished ? StopWish::pause : StopWish::none; };
  EXPECT_EQ(fake.run(path, plan), RunState::paused);
  EXPECT_TRUE(pictures_of(path).contains(kFirst));
  expect_resume_completes(plan);
}

// As on a second ctrl-C: the platform is stopped by another thread, and its way ends with an error.
TEST_F(TurningAhead, MayBeStoppedOnTheWay) {
  std::atomic<bool> wished = false;
  on_way = [&](double angle_rad) {
    if (angle_rad != angle_of(kSecond)) return;
    wished = true;
    throw std::runtime_error("the platform was stopped");
  };
  fake.options.stop_wish = [&] { return wished ? StopWish::now : StopWish::none; };
  EXPECT_EQ(fake.run(path, plan), RunState::aborted);
  EXPECT_TRUE(pictures_of(path).contains(kFirst));
  EXPECT_EQ(last_outcome(), "aborted");
  expect_resume_completes(plan);
}

TEST_F(TurningAhead, IsNotBegunWhenTheRunIsToEnd) {
  fake.options.choose_exposure = nullptr;
  fake.options.stop_wish = [&] { return fake.camera.captures > 1 ? StopWish::pause : StopWish::none; };
  EXPECT_EQ(fake.run(path, plan), RunState::paused);
  EXPECT_TRUE(pictures_of(path).contains(kFirst));
  EXPECT_TRUE(std::ranges::none_of(angles_rad, [&](double angle) { return angle == angle_of(kSecond); }));
}

}  // namespace
}  // namespace station

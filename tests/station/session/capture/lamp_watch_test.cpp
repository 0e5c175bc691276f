// Sessions whose lamp has just been switched on.
#include "station/session/capture/lamp_watch.h"

#include <cmath>

#include "station/session/capture/runner.h"
#include "tests/station/session/capture/runner_test.h"

namespace station {
namespace {

using testing::HasSubstr;

// A lamp that has a tenth less light when it is switched on, and gains it with a time constant of half a minute.
struct ColdLamp : RunnerTest {
  ColdLamp() {
    fake.camera.radiance = [this] {
      const bool on = !fake.person.asked.empty() && fake.person.asked.back().lamp != rig::Lamp::off;
      if (!on) on_since_s = -1;
      if (on && on_since_s < 0) on_since_s = fake.clock.monotonic_s();
      return on ? 1 - missing * std::exp(-(fake.clock.monotonic_s() - on_since_s) / time_constant_s) : 1.0;
    };
    fake.options.read_lamp = [](const PlanStep&, const rig::Picture& test) {
      return std::optional(FakeCamera::level(test) / test.settings.exposure_s);
    };
    fake.options.said = [this](const std::string& line) { said.push_back(line); };
  }
  std::vector<nlohmann::json> watches() const {
    std::vector<nlohmann::json> found;
    for (const JournalRecord& record : records_of(path))
      if (record.event == "lamp_watch") found.push_back(record.data);
    return found;
  }
  std::vector<std::string> warnings() const {
    std::vector<std::string> found;
    for (const JournalRecord& record : records_of(path))
      if (record.event == "warning") found.push_back(record.data.at("message"));
    return found;
  }
  double missing = 0.1, time_constant_s = 30, on_since_s = -1;
  std::vector<std::string> said;
};

TEST_F(ColdLamp, IsWaitedForAndThePersonIsToldSo) {
  EXPECT_EQ(fake.run(path, small_plan()), RunState::complete);
  ASSERT_EQ(watches().size(), 1U) << "from the front to behind it stays on";
  // 0.1 exp(-t / 30) (1 - exp(-10 / 30)) of the strength is gained in the ten seconds after t: below half a percent
  // from t = 52.
  EXPECT_EQ(watches()[0].at("waited_s"), 70);
  EXPECT_EQ(said.size(), 6U);
  EXPECT_THAT(said[0], HasSubstr("warming up (3.1 % in 10 s, 0.5 % is steady): waiting, 10 s so far, at most 600 s"));
}

TEST_F(ColdLamp, ThatIsWarmIsLookedAtOnceAndLeftAlone) {
  missing = 0;
  fake.run(path, small_plan());
  EXPECT_EQ(watches().at(0).at("test_pictures"), 2);
  EXPECT_TRUE(said.empty());
  EXPECT_TRUE(warnings().empty());
}

TEST_F(ColdLamp, ThatCannotBeReadIsSaidNotToBeWatched) {
  fake.options.read_lamp = [](const PlanStep&, const rig::Picture&) { return std::optional<double>(); };
  fake.run(path, small_plan());
  EXPECT_EQ(watches().at(0).at("test_pictures"), 1);
  EXPECT_FALSE(watches()[0].contains("change"));
  ASSERT_EQ(said.size(), 1U);
  EXPECT_THAT(said[0], HasSubstr("the lamp is not watched"));
  ASSERT_EQ(warnings().size(), 1U);
  EXPECT_THAT(warnings()[0], HasSubstr("the lamp is not watched"));
}

TEST_F(ColdLamp, ThatCannotBeReadAnyMoreIsSaidNotToBeWatched) {
  int readings = 0;
  fake.options.read_lamp = [&readings](const PlanStep&, const rig::Picture& test) {
    return ++readings < 3 ? std::optional(FakeCamera::level(test) / test.settings.exposure_s) : std::nullopt;
  };
  fake.run(path, small_plan());
  EXPECT_EQ(watches().at(0).at("test_pictures"), 3);
  ASSERT_EQ(said.size(), 2U);
  EXPECT_THAT(said[0], HasSubstr("warming up"));
  EXPECT_THAT(said[1], HasSubstr("the lamp is not watched"));
  EXPECT_EQ(warnings().size(), 1U);
}

TEST_F(ColdLamp, ThatNeverSettlesIsGivenUpInOneLineAndTheSessionResumes) {
  missing = -5, time_constant_s = 1000;  // fades: 0.7 % in the ten seconds after ten minutes
  const std::string message = message_of([&] { fake.run(path, small_plan()); });
  EXPECT_THAT(message, HasSubstr("the lamp still changes after 600 s"));
  EXPECT_EQ(message.find('\n'), std::string::npos);
  EXPECT_EQ(last_outcome(), "suspended");
  EXPECT_EQ(pictures_of(path).size(), 1U) << "no view was kept";
  expect_resume_completes(small_plan());
}

TEST_F(ColdLamp, MayBePausedWhileItIsWaitedFor) {
  fake.options.stop_wish = [this] { return said.empty() ? StopWish::none : StopWish::pause; };
  EXPECT_EQ(fake.run(path, small_plan()), RunState::paused);
  EXPECT_EQ(said.size(), 1U);
}

}  // namespace
}  // namespace station

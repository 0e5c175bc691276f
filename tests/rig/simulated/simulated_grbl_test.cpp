// The simulated firmware against what real GRBL 1.1h was recorded to answer: the same commands, the same lines.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "rig/turntables/grbl_reply.h"
#include "rig/turntables/line_frames.h"
#include "tests/rig/turntables/grbl_lines.h"
#include "tests/rig/turntables/wired_bench.h"

namespace {

using rig::kDegree;
using testing::ElementsAre;
using testing::IsEmpty;
using testing::MatchesRegex;

struct SimulatedGrbl : testing::Test {
  explicit SimulatedGrbl(rig::HomeBy home_by = rig::HomeBy::here) : rig(Protocol::grbl, home_by) {
    say("$100=40\n$110=1800\n$120=100\n$130=360\n$1=255\n$10=1\n");
    say("\x18");
  }

  // What it answers at once; empty lines are left out.
  std::vector<std::string> say(const std::string& bytes) {
    rig.port->receive(bytes);
    return hear();
  }
  std::vector<std::string> hear() {
    rig::LineFrames frames;
    frames.add(std::exchange(heard_, {}) + rig.port->transmit());
    std::vector<std::string> lines;
    while (const auto line = frames.next()) lines.push_back(*line);
    return lines;
  }
  rig::GrblStatus status() {
    for (const std::string& line : say("?")) {
      const auto reply = rig::parse_grbl_line(line);
      if (const auto* found = std::get_if<rig::GrblStatus>(&reply)) return *found;
    }
    ADD_FAILURE() << "no status";
    return {};
  }
  // In slices, as time passes for a firmware.
  void wait(double s) {
    for (const double until_s = rig.clock.monotonic_s() + s; rig.clock.monotonic_s() < until_s;) {
      rig.clock.sleep_s(0.01);
      heard_ += rig.port->transmit();
    }
  }

  WiredBench<rig::SimulatedClock> rig;
  std::string heard_;
};

struct SimulatedGrblWithSwitch : SimulatedGrbl {
  SimulatedGrblWithSwitch() : SimulatedGrbl(rig::HomeBy::home_switch) {}
};

}  // namespace

TEST_F(SimulatedGrbl, SaysItsBannerStatusVersionAndSettings) {
  EXPECT_THAT(say("\x18"), ElementsAre(kBanner));
  EXPECT_THAT(say("?"), ElementsAre("<Idle|MPos:0.000,0.000,0.000|FS:0,0|WCO:0.000,0.000,0.000>"));
  EXPECT_THAT(say("$I\n"), ElementsAre("[VER:1.1h.20190830:]", "[OPT:V,15,128]", "ok"));
  EXPECT_THAT(say("$X\n"), ElementsAre("ok"));
  EXPECT_THAT(say("$100=40\n$1=255\n"), ElementsAre("ok", "ok"));
  const auto settings = say("$$\n");
  EXPECT_EQ(settings.front(), "$0=10");
  EXPECT_EQ(settings.back(), "ok");
  EXPECT_THAT(settings, testing::IsSupersetOf({"$100=40.000", "$110=1800.000", "$120=100.000", "$132=200.000"}));
}

TEST_F(SimulatedGrbl, AcknowledgesAMoveBeforeItIsDone) {
  EXPECT_THAT(say("G91 G0 X30 F1800\n"), ElementsAre("ok"));
  wait(0.05);
  const auto running = status();
  EXPECT_EQ(running.state, rig::GrblState::run);
  EXPECT_LT(*running.machine_deg, 30);
  EXPECT_THAT(say("G91 G1 X10 F600\n"), ElementsAre("ok"));
  EXPECT_THAT(say("G4 P0\n"), IsEmpty());  // until the planner has drained
  wait(5);
  EXPECT_THAT(hear(), ElementsAre("ok"));
  const auto done = status();
  EXPECT_EQ(done.state, rig::GrblState::idle);
  EXPECT_EQ(done.machine_deg, 40);
}

TEST_F(SimulatedGrbl, HoldsResumesAndStopsCleanly) {
  EXPECT_THAT(say("G90 G1 X100 F1800\n"), ElementsAre("ok"));
  wait(1);
  EXPECT_THAT(say("!"), IsEmpty());
  wait(0.01);
  EXPECT_EQ(status().state, rig::GrblState::hold_moving);
  wait(1);
  const auto held = status();
  EXPECT_EQ(held.state, rig::GrblState::hold);
  EXPECT_THAT(say("~"), IsEmpty());
  wait(0.1);
  EXPECT_EQ(status().state, rig::GrblState::run);
  say("!");
  wait(1);
  const auto stopped = status();
  EXPECT_GT(*stopped.machine_deg, *held.machine_deg);
  EXPECT_THAT(say("\x18"), ElementsAre(kBanner));
  EXPECT_EQ(status().state, rig::GrblState::idle);
  EXPECT_EQ(status().machine_deg, stopped.machine_deg);
}

TEST_F(SimulatedGrbl, LosesItsPlaceWhenResetWhileMoving) {
  say("G90 G1 X100 F1800\n");
  wait(1);
  EXPECT_THAT(say("\x18"), ElementsAre("ALARM:3", kBanner, kUnlock));
  EXPECT_EQ(status().state, rig::GrblState::alarm);
  EXPECT_THAT(say("G91 G0 X1\n"), ElementsAre("error:9"));
  EXPECT_THAT(say("$X\n"), ElementsAre("[MSG:Caution: Unlocked]", "ok"));
}

TEST_F(SimulatedGrbl, RefusesWithTheCodesOfTheFirmware) {
  EXPECT_THAT(say("FOO\n"), ElementsAre("error:2"));
  EXPECT_THAT(say("G0 X\n"), ElementsAre("error:2"));
  EXPECT_THAT(say("G1 X10\n"), ElementsAre("error:22"));
  EXPECT_THAT(say("G1 X10 F0\n"), ElementsAre("error:22"));
  EXPECT_THAT(say("$H\n"), ElementsAre("error:5"));
  EXPECT_THAT(say("$200=1\n"), ElementsAre("error:3"));
  EXPECT_THAT(say("$20=1\n"), ElementsAre("error:10"));
}

TEST_F(SimulatedGrbl, AJogIsCancelledWithoutAnAlarm) {
  EXPECT_THAT(say("$J=G91 X10 F1000\n"), ElementsAre("ok"));
  wait(0.1);
  EXPECT_EQ(status().state, rig::GrblState::jog);
  EXPECT_THAT(say("\x85"), IsEmpty());
  wait(0.5);
  const auto after = status();
  EXPECT_EQ(after.state, rig::GrblState::idle);
  EXPECT_LT(*after.machine_deg, 10);
}

TEST_F(SimulatedGrblWithSwitch, IsSilentAfterASoftLimitUntilItIsReset) {
  say("$X\n");
  EXPECT_THAT(say("$22=1\n$20=1\n$130=20\n"), ElementsAre("ok", "ok", "ok"));
  EXPECT_THAT(say("G91 G0 X5\n"), ElementsAre("ALARM:2", "[MSG:Reset to continue]"));
  EXPECT_THAT(say("?"), IsEmpty());
  EXPECT_THAT(say("$X\n"), IsEmpty());
  EXPECT_THAT(say("\x18"), ElementsAre(kBanner, kUnlock));
}

TEST_F(SimulatedGrblWithSwitch, HomesAndAnswersLate) {
  EXPECT_EQ(status().state, rig::GrblState::alarm);  // locked until it is homed
  EXPECT_THAT(say("$H\n"), IsEmpty());
  EXPECT_THAT(say("?"), IsEmpty());
  wait(10);
  EXPECT_THAT(hear(), ElementsAre(MatchesRegex("<Home\\|.*>"), "ok"));
  EXPECT_EQ(status().state, rig::GrblState::idle);
  EXPECT_EQ(status().machine_deg, -2);  // the pull-off
  EXPECT_NEAR(rig.true_angle_rad(), 0, 1e-12);
}

TEST_F(SimulatedGrblWithSwitch, AResetEndsHomingWithAnAlarm) {
  say("$H\n");
  wait(0.5);
  EXPECT_THAT(say("\x18"), ElementsAre("ALARM:6", kBanner, kUnlock));
}

TEST_F(SimulatedGrbl, TellsItsOffsets) {
  say("G0 X-2\n");
  wait(2);
  EXPECT_THAT(say("G92 X0\n"), ElementsAre("ok"));
  const auto offsets = say("$#\n");
  EXPECT_EQ(offsets.front(), "[G54:0.000,0.000,0.000]");
  EXPECT_THAT(offsets, testing::IsSupersetOf({"[G92:-2.000,0.000,0.000]", "[TLO:0.000]", "ok"}));
}

TEST_F(SimulatedGrbl, ReportsTheOffsetOnlyNowAndThen) {
  int with_offset = 0;
  for (int i = 0; i < 30; ++i) with_offset += status().work_offset_deg.has_value();
  EXPECT_EQ(with_offset, 3);  // every tenth
}

TEST_F(SimulatedGrbl, TurnsTheBenchAndTakesTheTimeOfTheWay) {
  const double before_rad = rig.true_angle_rad();
  say("G90 G0 X30\n");
  wait(0.9);
  EXPECT_EQ(status().state, rig::GrblState::run);
  wait(0.5);  // 30 deg at 30 deg/s, 0.2 s more for speeding up and slowing down
  EXPECT_EQ(status().state, rig::GrblState::idle);
  EXPECT_NEAR(rig.true_angle_rad() - before_rad, 30 * kDegree, 1e-12);
}

// The second simulation of GRBL against the documentation that it was written from, and its motion against mechanics.
#include "tests/support/documented_grbl.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "rig/turntables/line_frames.h"
#include "tests/rig/turntables/grbl_lines.h"

namespace {

using testing::ElementsAre;
using testing::IsEmpty;
using Lines = std::vector<std::string>;

// A board that has homing switched off unless a test says otherwise, so that it is not locked.
struct Bench {
  explicit Bench(DocumentedGrblOptions options = {}, const std::map<int, double>& others = {{22, 0}})
      : board(clock, made(std::move(options), others)) {
    hear(0);
  }
  static DocumentedGrblOptions made(DocumentedGrblOptions options, const std::map<int, double>& others) {
    options.eeprom = documented_turntable_settings();
    for (const auto& [number, value] : others) options.eeprom[number] = value;
    options.resets_when_opened = false;
    return options;
  }
  Lines hear(double for_s) {
    const double until_s = clock.monotonic_s() + for_s;
    do {
      frames.add(line->read(0.01));
    } while (clock.monotonic_s() < until_s);
    Lines lines;
    while (const auto one = frames.next()) lines.push_back(*one);
    return lines;
  }
  Lines say(const std::string& bytes, double for_s = 0.02) {
    line->write(bytes);
    return hear(for_s);
  }
  std::string status() {
    const Lines lines = say("?");
    return lines.empty() ? "" : lines.back();
  }

  rig::SimulatedClock clock{1.8e9};
  DocumentedGrbl board;
  std::unique_ptr<rig::ByteLine> line = board.open();
  rig::LineFrames frames;
};

}  // namespace

TEST(DocumentedGrbl, ReportsItsStateWithItsOffsetFirstAndItsOverridesNext) {
  Bench bench;
  EXPECT_THAT(bench.say("\x18"), ElementsAre(kBanner));
  EXPECT_EQ(bench.status(), "<Idle|MPos:0.000,0.000,0.000|FS:0,0|WCO:0.000,0.000,0.000>");
  EXPECT_EQ(bench.status(), "<Idle|MPos:0.000,0.000,0.000|FS:0,0|Ov:100,100,100>");
  EXPECT_EQ(bench.status(), "<Idle|MPos:0.000,0.000,0.000|FS:0,0>");
  EXPECT_THAT(bench.say("???"), testing::SizeIs(1));  // further questions before the report are ignored
}

TEST(DocumentedGrbl, AnswersItsQueries) {
  Bench bench;
  EXPECT_THAT(bench.say("$I\n"), ElementsAre("[VER:1.1h.20190830:]", "[OPT:V,15,128]", "ok"));
  EXPECT_THAT(bench.say("$G\n"), ElementsAre("[GC:G0 G54 G17 G21 G90 G94 M5 M9 T0 F0 S0]", "ok"));
  EXPECT_THAT(bench.say("$$\n"), testing::AllOf(testing::Contains("$0=10"), testing::Contains("$100=40.000"),
                                                testing::Contains("$24=90.000"), testing::SizeIs(35)));
  EXPECT_THAT(bench.say("G92 X2\n$#\n"), testing::Contains("[G92:-2.000,0.000,0.000]"));
  EXPECT_THAT(bench.say("\n"), ElementsAre("ok"));
}

TEST(DocumentedGrbl, NumbersItsErrorsAsTheDocumentsDo) {
  Bench bench;
  const std::map<std::string, std::string> kErrors{{"X", "error:2"},
                                                   {"7", "error:1"},
                                                   {"$FOO", "error:3"},
                                                   {"$100=-1", "error:4"},
                                                   {"$H", "error:5"},
                                                   {"$0=2", "error:6"},
                                                   {"$20=1", "error:10"},
                                                   {"G81", "error:20"},
                                                   {"G0 G1", "error:21"},
                                                   {"G1 X1", "error:22"},
                                                   {"X1 X2", "error:25"},
                                                   {"G92", "error:26"},
                                                   {"G4", "error:28"},
                                                   {"G80 X1", "error:31"},
                                                   {"G0 I1", "error:36"},
                                                   {"$J=X1", "error:22"},
                                                   {"$J=M3 X1", "error:16"},
                                                   {"$HX", "error:3"},
                                                   {std::string(90, 'G'), "error:11"}};
  for (const auto& [line, error] : kErrors) EXPECT_THAT(bench.say(line + "\n"), ElementsAre(error)) << line;
}

TEST(DocumentedGrbl, KeepsItsSettingsOverAResetAndForgetsItsPlaceWithThePower) {
  Bench bench;
  EXPECT_THAT(bench.say("$110=600\nG0 X30\n", 5), ElementsAre("ok", "ok"));
  bench.say("\x18");
  EXPECT_THAT(bench.status(), testing::StartsWith("<Idle|MPos:30.000,"));
  EXPECT_EQ(bench.board.settings().at(110), 600);
  bench.board.unplug();
  EXPECT_THROW(bench.line->read(0), rig::Unplugged);
  bench.board.plug_in();
  bench.hear(0.02);
  EXPECT_THAT(bench.status(), testing::StartsWith("<Idle|MPos:0.000,"));
  EXPECT_EQ(bench.board.settings().at(110), 600);
  EXPECT_NEAR(bench.board.platform_deg(), 80, 1e-9);
}

// 30 deg/s and 150 deg/s^2: 0.2 s and 3 deg to full speed.
TEST(DocumentedGrbl, MovesByATrapezoidOfSpeed) {
  Bench bench;
  bench.say("G0 X60\n", 10);
  const auto log = bench.board.log();
  ASSERT_GT(log.size(), 100u);
  const double began_s = log.front().at_s, ended_s = log.back().at_s;
  EXPECT_NEAR(ended_s - began_s, 60 / 30.0 + 0.2, 0.011);  // two looks
  double fastest = 0;
  for (std::size_t i = 1; i < log.size(); ++i) {
    if (log[i].at_s - log[i - 1].at_s < 0.004) continue;  // the end of a wait cut a look short
    const double speed = (log[i].platform_deg - log[i - 1].platform_deg) / (log[i].at_s - log[i - 1].at_s);
    fastest = std::max(fastest, speed);
    const double since_s = log[i].at_s - began_s;
    if (since_s < 0.2) EXPECT_NEAR(log[i].platform_deg - 50, 75 * since_s * since_s, 0.25);  // a look's way, a step
  }
  EXPECT_NEAR(fastest, 30, 5.1);  // a step within a look is 5 deg/s
  EXPECT_NEAR(bench.board.platform_deg(), 110, 1e-9);
  EXPECT_FALSE(bench.board.turning());
}

TEST(DocumentedGrbl, JoinsMovesThatGoTheSameWayAndStandsBetweenThoseThatTurnBack) {
  Bench bench;
  bench.say("G0 X10\nG0 X20\nG0 X30\n", 10);
  const auto joined = bench.board.log();
  EXPECT_NEAR(joined.back().at_s - joined.front().at_s, 1.2, 0.02);
  bench.say("G0 X40\nG0 X30\n", 10);
  const auto back = bench.board.log();
  EXPECT_NEAR(back.back().at_s - back.at(joined.size()).at_s, 2 * (1 / 3.0 + 0.2), 0.03);
}

TEST(DocumentedGrbl, HoldsAndGoesOn) {
  Bench bench;
  bench.say("G0 X100\n", 1);
  EXPECT_THAT(bench.say("!", 0), IsEmpty());
  EXPECT_THAT(bench.status(), testing::StartsWith("<Hold:1|"));
  bench.hear(0.5);
  EXPECT_THAT(bench.status(), testing::StartsWith("<Hold:0|"));
  EXPECT_THAT(bench.say("G0 X0\n", 1), IsEmpty());  // suspended: lines wait
  bench.say("~", 20);
  EXPECT_NEAR(bench.board.platform_deg(), 50, 1e-9);  // X100, then the line that waited
}

TEST(DocumentedGrbl, AResetAfterAHoldKeepsThePlaceAndOneInMotionDoesNot) {
  Bench bench;
  bench.say("G0 X100\n", 1);
  bench.say("!", 0.5);
  EXPECT_THAT(bench.say("\x18"), ElementsAre(kBanner));
  EXPECT_THAT(bench.say("G0 X0\n", 10), ElementsAre("ok"));
  EXPECT_NEAR(bench.board.platform_deg(), 50, 1e-9);
  bench.say("G0 X100\n", 1);
  EXPECT_THAT(bench.say("\x18"), ElementsAre("ALARM:3", kBanner, kUnlock));
  EXPECT_THAT(bench.say("G0 X0\n"), ElementsAre("error:9"));
  EXPECT_THAT(bench.say("$X\n"), ElementsAre("[MSG:Caution: Unlocked]", "ok"));
  EXPECT_THAT(bench.say("G0 X0\n", 10), ElementsAre("ok"));
  EXPECT_GT(std::abs(bench.board.platform_deg() - 50), 0.1);
}

TEST(DocumentedGrbl, KeepsItsPlaceOverAThousandStopsAtRandomMoments) {
  Bench bench;
  std::mt19937 random(7);
  std::uniform_real_distribution<double> angle(-90, 90), moment_s(0, 4);
  for (int stop = 0; stop < 1000; ++stop) {
    std::string moves;
    for (int i = 0; i < 3; ++i) moves += "G0 X" + std::to_string(angle(random)) + "\n";
    bench.say(moves, moment_s(random));
    bench.say("!", 0.3);  // 0.2 s to slow down
    ASSERT_FALSE(bench.board.turning());
    ASSERT_THAT(bench.say("\x18"), testing::Contains(kBanner));
    const std::string status = bench.status();
    ASSERT_THAT(status, testing::StartsWith("<Idle|MPos:"));
    ASSERT_NEAR(std::stod(status.substr(11)), bench.board.platform_deg() - 50, 0.0006);  // three decimals
  }
}

TEST(DocumentedGrbl, AHoldOvertakesTheLineBeforeIt) {
  Bench bench;
  EXPECT_THAT(bench.say("G0 X100\n!", 1), IsEmpty());
  EXPECT_FALSE(bench.board.turning());
  EXPECT_THAT(bench.status(), testing::StartsWith("<Hold:0|"));
}

TEST(DocumentedGrbl, CancelsAJogByEitherCharacterAndIsIdleThen) {
  for (const char* cancel : {"\x85", "!"}) {
    Bench bench;
    EXPECT_THAT(bench.say("$J=G91 X100 F1800\n$J=G91 X100 F1800\n", 1), ElementsAre("ok", "ok"));
    EXPECT_THAT(bench.status(), testing::StartsWith("<Jog|"));
    EXPECT_THAT(bench.say("G0 X1\n"), ElementsAre("error:9"));
    EXPECT_THAT(bench.say(cancel, 1), IsEmpty());
    EXPECT_THAT(bench.status(), testing::StartsWith("<Idle|"));
    EXPECT_LT(bench.board.platform_deg(), 50 + 37);
  }
}

TEST(DocumentedGrbl, PlansFifteenMovesAndKeepsTheOthersWaiting) {
  Bench bench;
  std::string moves;
  for (int i = 1; i <= 16; ++i) moves += "G0X" + std::to_string(i) + "\n";
  EXPECT_THAT(bench.say(moves, 0.02), testing::SizeIs(15));
  EXPECT_THAT(bench.hear(3), testing::SizeIs(1));
  EXPECT_NEAR(bench.board.platform_deg(), 66, 1e-9);
}

TEST(DocumentedGrbl, DwellsWhenItsMovesHaveEnded) {
  Bench bench;
  EXPECT_THAT(bench.say("G0 X30\nG4 P0.5\n", 1), ElementsAre("ok"));
  EXPECT_THAT(bench.hear(0.5), IsEmpty());
  EXPECT_THAT(bench.hear(0.5), ElementsAre("ok"));
}

TEST(DocumentedGrbl, StopsAtSoftLimitsAndWaitsForAReset) {
  Bench bench({}, {{20, 1}, {22, 1}});
  bench.say("$X\n");
  EXPECT_THAT(bench.say("$J=X5 F100\n"), ElementsAre("error:15"));
  EXPECT_THAT(bench.say("G0 X5\n"), ElementsAre("ALARM:2", "[MSG:Reset to continue]"));
  EXPECT_THAT(bench.say("?$$\n", 1), IsEmpty());
  EXPECT_THAT(bench.say("\x18"), ElementsAre(kBanner, kUnlock));
}

TEST(DocumentedGrbl, StopsHardWhenItRunsIntoItsSwitch) {
  Bench bench({}, {{21, 1}, {22, 0}});
  EXPECT_THAT(bench.say("G0 X-60\n", 5), ElementsAre("ok", "ALARM:1", "[MSG:Reset to continue]"));
  EXPECT_NEAR(bench.board.platform_deg(), 2.5, 2);  // the switch is there, and it coasts
}

// The switch closes at 2 deg; the pull-off of 1 deg leaves it at 1 deg.
TEST(DocumentedGrbl, HomesOnItsSwitchAndCountsFromThePullOff) {
  Bench bench({.homes_single_axis = true}, {});
  EXPECT_THAT(bench.say("\x18"), ElementsAre(kBanner, kUnlock));
  EXPECT_THAT(bench.say("$HX\n", 1), IsEmpty());
  EXPECT_THAT(bench.say("?", 1), IsEmpty());  // homing answers nothing
  EXPECT_THAT(bench.hear(40), ElementsAre("ok"));
  EXPECT_NEAR(bench.board.platform_deg(), 361, 1e-9);
  EXPECT_THAT(bench.status(), testing::StartsWith("<Idle|MPos:-1.000,"));
}

TEST(DocumentedGrbl, LooksForTheSwitchOverOneAndAHalfTravels) {
  for (const auto& [travel, said] : std::map<double, std::string>{{207, "ALARM:9"}, {209, "ok"}}) {  // 312 deg away
    Bench bench({}, {{130, travel}});
    EXPECT_THAT(bench.say("$H\n", 60), ElementsAre(said)) << travel;
  }
}

TEST(DocumentedGrbl, HomesZFirstAsItComesAndFindsNoSwitchThere) {
  Bench bench({.homing = DocumentedGrblOptions::Homing::z_first}, {});
  EXPECT_THAT(bench.say("$H\n", 120), ElementsAre("ALARM:9"));
  EXPECT_THAT(bench.board.log(), IsEmpty());  // the platform did not turn
}

TEST(DocumentedGrbl, SaysThatItsSwitchStaysClosedAndThatItsHomingWasEnded) {
  Bench wide({.switch_width_deg = 350}, {});
  EXPECT_THAT(wide.say("$H\n", 60), ElementsAre("ALARM:8"));
  Bench ended({}, {});
  ended.say("$H\n", 1);
  EXPECT_THAT(ended.say("\x18"), ElementsAre("ALARM:6", kBanner, kUnlock));
}

TEST(DocumentedGrbl, TakesTimeToStartWhenItsPortIsOpened) {
  rig::SimulatedClock clock(1.8e9);
  DocumentedGrbl board(clock);
  const auto line = board.open();
  EXPECT_THROW(board.open(), std::runtime_error);  // one program alone
  line->write("$I\n");
  EXPECT_EQ(line->read(1.4), "");
  EXPECT_THAT(line->read(1), testing::HasSubstr(kBanner));
}

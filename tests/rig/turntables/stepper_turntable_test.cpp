// The driver over simulated firmware on a line without a wire: what an angle becomes, and what stops it.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <iostream>
#include <limits>
#include <random>

#include "rig/devices/device_contract.h"
#include "rig/turntables/stopping.h"
#include "tests/rig/turntables/ended_program.h"
#include "tests/rig/turntables/wired_bench.h"
#include "tests/support/refusal.h"

namespace {

using rig::kDegree;
using testing::HasSubstr;

using Rig = WiredBench<EventfulClock>;

// A line on which something happens right before a write reaches the firmware.
class WatchedLine final : public rig::ByteLine {
 public:
  WatchedLine(std::unique_ptr<rig::ByteLine> line, std::function<void(std::string_view)> before_write)
      : line_(std::move(line)), before_write_(std::move(before_write)) {}
  std::string read(double timeout_s) override { return line_->read(timeout_s); }
  void write(std::string_view bytes) override {
    before_write_(bytes);
    line_->write(bytes);
  }

 private:
  std::unique_ptr<rig::ByteLine> line_;
  std::function<void(std::string_view)> before_write_;
};

struct StepperTurntable : testing::TestWithParam<Protocol> {
  Rig rig{GetParam()};

  // `work` with a stop before its Nth write, for N = 1, 2 ... until the work ends before. A stop that was asked before
  // the command to turn was written counts as much as a later one.
  using Work = std::function<void(rig::Turntable&, Rig&)>;
  void expect_stopped_before_every_write(const Work& prepare, const Work& work, const std::string& message) {
    for (int at = 1;; ++at) {
      SCOPED_TRACE("stop before write " + std::to_string(at));
      Rig own(GetParam());
      std::unique_ptr<rig::Turntable> table;
      int writes = 0;
      double angle_rad = 0, told_s = -1;
      const auto before_write = [&](std::string_view) {
        if (writes >= 0 && ++writes == at) {
          writes = -1;  // the stop's own
          angle_rad = own.true_angle_rad();
          told_s = own.clock.monotonic_s();
          table->stop();
        }
      };
      own.open_line = [&] {
        return std::make_unique<WatchedLine>(rig::open_simulated_line(own.port, own.clock), before_write);
      };
      writes = -1;
      table = own.make_turntable();
      prepare(*table, own);
      writes = 0;
      const std::string said = refusal([&] { work(*table, own); });
      if (told_s < 0) {
        EXPECT_GT(at, 3);
        return;
      }
      EXPECT_LE(std::abs(own.true_angle_rad() - angle_rad), 5 * kDegree);
      EXPECT_THAT(said, HasSubstr(message));
      const double stood_rad = own.true_angle_rad();
      own.clock.sleep_s(5);
      own.port->transmit();
      EXPECT_EQ(own.true_angle_rad(), stood_rad);
      table->home();
      EXPECT_NEAR(own.true_angle_rad(), 0, 1e-12);
    }
  }
};

INSTANTIATE_TEST_SUITE_P(OverTheWire, StepperTurntable,
                         testing::Values(Protocol::grbl, Protocol::documented_grbl, Protocol::zaber),
                         testing::PrintToStringParamName());

}  // namespace

TEST_P(StepperTurntable, KeepsTheContractOfTurntables) {
  WiredBench<rig::SimulatedClock> own(GetParam());
  const auto table = own.make_turntable();
  for (const rig::ContractRow& row : rig::check_turntable(*table, own.kStepRad))
    EXPECT_TRUE(row.passed) << row.name << ": " << row.what;
}

TEST_P(StepperTurntable, KnowsNoAngleUntilItIsHomed) {
  const auto table = rig.make_turntable();
  EXPECT_EQ(table->state(), rig::TurntableState::unknown_position);
  const int before = rig.port->operations();
  EXPECT_THAT(refusal([&] { table->move_to(0.1); }), HasSubstr("home it first"));
  EXPECT_THAT(refusal([&] { table->angle_rad(); }), HasSubstr("home it first"));
  EXPECT_EQ(rig.port->operations(), before);
}

TEST_P(StepperTurntable, StandsAtTheNearestStepAndReadsItBack) {
  const auto table = rig.make_turntable();
  table->home();
  EXPECT_NEAR(rig.true_angle_rad(), 0, 1e-12);
  for (const double wanted_deg : {30.01, -77.7, 359.99, 0.0, -360.0}) {
    table->move_to(wanted_deg * kDegree);
    const double expected_rad = std::round(wanted_deg * rig.kStepsPerDeg) * rig.kStepRad;
    EXPECT_NEAR(table->angle_rad(), expected_rad, 1e-12);
    EXPECT_NEAR(rig.true_angle_rad(), expected_rad, 1e-12);  // sums of doubles
    EXPECT_EQ(table->state(), rig::TurntableState::idle);
  }
}

TEST_P(StepperTurntable, RefusesAnglesThatAreNoneBeforeTheWire) {
  const auto table = rig.make_turntable();
  table->home();
  const int before = rig.port->operations();
  for (const double angle_rad : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity(),
                                 361 * kDegree, -361 * kDegree, 1e300})
    EXPECT_THAT(refusal([&] { table->move_to(angle_rad); }), HasSubstr("it turns between -360.000000 deg and"));
  EXPECT_EQ(rig.port->operations(), before);
  EXPECT_EQ(table->state(), rig::TurntableState::idle);
}

TEST_P(StepperTurntable, RefusesMoreStepsThanTheFirmwareCanCount) {
  rig.stepper.limit_rad = 1e9;
  const auto table = rig.make_turntable();
  table->home();
  const int before = rig.port->operations();
  EXPECT_THAT(refusal([&] { table->move_to(1e8); }), HasSubstr("more steps"));
  EXPECT_EQ(rig.port->operations(), before);
}

TEST_P(StepperTurntable, ApproachesFromOneSideWhenItHasBacklash) {
  rig.stepper.backlash_rad = 3 * kDegree;
  const auto table = rig.make_turntable();
  table->home();
  table->move_to(60 * kDegree);
  double least_rad = 1e9;
  std::function<void()> watch = [&] {
    least_rad = std::min(least_rad, rig.true_angle_rad());
    rig.clock.plan(0, watch);
  };
  rig.clock.plan(0, watch);
  table->move_to(30 * kDegree);
  EXPECT_NEAR(least_rad, 27 * kDegree, 1e-9);
  EXPECT_NEAR(rig.true_angle_rad(), 30 * kDegree, 1e-12);
  least_rad = 1e9;
  table->move_to(45 * kDegree);
  rig.clock.plan(0, [] {});
  EXPECT_NEAR(least_rad, 30 * kDegree, 1e-9);
}

TEST_P(StepperTurntable, AStopEndsTheMoveKeepsThePositionAndTheNextMoveGoesOn) {
  for (const double after_s : {0.06, 0.3, 1.0, 2.5, 3.1}) {
    Rig own(GetParam());
    const auto table = own.make_turntable();
    table->home();
    own.clock.plan(after_s, [&] {
      EXPECT_EQ(table->state(), rig::TurntableState::moving);
      table->stop();
    });
    EXPECT_THAT(refusal([&] { table->move_to(90 * kDegree); }), HasSubstr("was stopped at"));
    EXPECT_EQ(table->state(), rig::TurntableState::stopped);
    const double stood_rad = own.true_angle_rad();
    // 22.75 deg/s, and 2 deg to slow down.
    EXPECT_LE(stood_rad, 22.75 * kDegree * after_s + 2 * kDegree);
    EXPECT_NEAR(table->angle_rad(), stood_rad, 1e-12);
    own.clock.sleep_s(5);
    EXPECT_EQ(own.true_angle_rad(), stood_rad);
    table->move_to(90 * kDegree);
    EXPECT_NEAR(own.true_angle_rad(), 90 * kDegree, 1e-12);
    EXPECT_EQ(table->state(), rig::TurntableState::idle);
  }
}

TEST_P(StepperTurntable, AProgramThatIsKilledLeavesAPlatformThatStopsWithinASecond) {
  constexpr unsigned kSeed = 2611;
  std::cout << "seed " << kSeed << "\n";
  std::mt19937 random(kSeed);
  for (int i = 0; i < 50; ++i) {
    const double after_s = std::uniform_real_distribution(0.0, 15.0)(random);
    SCOPED_TRACE("killed after " + std::to_string(after_s) + " s");
    Rig own(GetParam());
    std::atomic<bool> killed = false;
    own.open_line = [&] {
      return std::make_unique<MortalLine>(rig::open_simulated_line(own.port, own.clock), own.clock, killed);
    };
    const auto table = own.make_turntable();
    table->home();
    double killed_at_rad = 0;
    own.clock.plan(after_s, [&] {
      own.port->transmit();  // brings the motor up to the clock's time
      killed_at_rad = own.true_angle_rad();
      killed = true;
    });
    EXPECT_THAT(refusal([&] { table->move_to(360 * kDegree); }), HasSubstr("did not answer"));
    own.port->transmit();
    // 22.8 deg/s: what the simulated motor's 150 deg/s^2 can stop within 4 degrees.
    EXPECT_LE(own.true_angle_rad() - killed_at_rad, 22.8 * kDegree);
  }
}

TEST_P(StepperTurntable, TurnsThroughItsPiecesWithoutSlowingDown) {
  const auto table = rig.make_turntable();
  table->home();
  const double begin_s = rig.clock.monotonic_s();
  table->move_to(360 * kDegree);
  // 22.75 deg/s, 0.15 s to reach it and as much to stop, and two readings.
  EXPECT_NEAR(rig.clock.monotonic_s() - begin_s, 360 / 22.75 + 0.15 + 0.1, 0.15);
}

TEST(StoppableSpeed, IsThatFromWhichAPlatformStandsWithinFourDegreesOfAStopThatIsATenthOfASecondLate) {
  for (const double acceleration : {5.0, 100.0, 1000.0}) {
    const double speed = rig::stoppable_speed_deg_s(acceleration);
    EXPECT_NEAR(speed * speed / (2 * acceleration) + 0.1 * speed, 4, 1e-9);
  }
}

TEST_P(StepperTurntable, AStopBeforeAnyWriteOfAMoveStopsThePlatform) {
  expect_stopped_before_every_write([](rig::Turntable& table, Rig&) { table.home(); },
                                    [](rig::Turntable& table, Rig&) { table.move_to(90 * kDegree); }, "was stopped at");
}

TEST_P(StepperTurntable, AStopBeforeAnyWriteOfAHomingStopsThePlatform) {
  expect_stopped_before_every_write([](rig::Turntable&, Rig&) {}, [](rig::Turntable& table, Rig&) { table.home(); },
                                    "home it again");
}

TEST_P(StepperTurntable, AStopBeforeAnyWriteOfAnotherConnectionStopsThePlatform) {
  expect_stopped_before_every_write(
      [](rig::Turntable& table, Rig& own) {
        own.port->unplug();
        EXPECT_THROW(table.home(), rig::Unplugged);
        own.port->power_on();
      },
      [](rig::Turntable& table, Rig&) { table.home(); }, "home it again");
}

TEST_P(StepperTurntable, ABoardThatWasUnpluggedIsNotStartedByOpeningItsLine) {
  rig.port->unplug();
  rig.port->opened();
  EXPECT_FALSE(rig.port->plugged());
  EXPECT_THROW(rig.make_turntable(), rig::Unplugged);
  rig.port->power_on();
  rig.make_turntable()->home();
  EXPECT_NEAR(rig.true_angle_rad(), 0, 1e-12);
}

TEST_P(StepperTurntable, AStopWhileStandingKeepsThePosition) {
  const auto table = rig.make_turntable();
  table->home();
  table->move_to(20 * kDegree);
  table->stop();
  EXPECT_EQ(table->state(), rig::TurntableState::stopped);
  EXPECT_NEAR(table->angle_rad(), 20 * kDegree, 1e-12);
  table->move_to(0);
  EXPECT_NEAR(rig.true_angle_rad(), 0, 1e-12);
}

TEST_P(StepperTurntable, AStopWhileHomingLeavesThePositionUnknown) {
  const auto table = rig.make_turntable();
  rig.clock.plan(0.5, [&] { table->stop(); });
  EXPECT_THAT(refusal([&] { table->home(); }), HasSubstr("home it again"));
  EXPECT_EQ(table->state(), rig::TurntableState::unknown_position);
  const double stood_rad = rig.true_angle_rad();
  rig.clock.sleep_s(5);
  EXPECT_EQ(rig.true_angle_rad(), stood_rad);
  table->home();
  EXPECT_NEAR(rig.true_angle_rad(), 0, 1e-12);
}

TEST_P(StepperTurntable, RefusesAControllerThatIsSetUpForOtherSteps) {
  rig.setup.steps_per_deg = 44.4;
  EXPECT_THAT(refusal([&] { rig.make_turntable(); }),
              testing::AllOf(HasSubstr("40"), HasSubstr("44.4"), HasSubstr("rig file")));
}

TEST_P(StepperTurntable, SaysWhatAWrongDeviceAnswered) {
  rig.port = rig::make_simulated_port(rig::make_echo());
  const std::string said = refusal([&] { rig.make_turntable(); });
  EXPECT_THAT(said, testing::AllOf(HasSubstr("answered \""), HasSubstr("rig file"), HasSubstr("threadstation devices")))
      << said;
}

TEST_P(StepperTurntable, IsFoundAgainByItsSerialNumberAtAnotherPort) {
  const auto table = rig.make_turntable();
  table->home();
  rig.port->unplug();
  EXPECT_THAT(refusal([&] { table->move_to(0.5); }), HasSubstr("unplugged"));
  EXPECT_EQ(table->state(), rig::TurntableState::unknown_position);
  // Opening by serial number now gives another port.
  rig.power_on_another();
  table->home();
  table->move_to(30 * kDegree);
  EXPECT_NEAR(rig.true_angle_rad(), 30 * kDegree, 1e-12);
}

TEST(StepperTurntableHere, TakesThePlaceWhereItStandsForZeroAndReturnsThere) {
  Rig rig(Protocol::grbl, rig::HomeBy::here);
  const auto table = rig.make_turntable();
  const double start_rad = rig.true_angle_rad();
  table->home();
  EXPECT_EQ(table->angle_rad(), 0);
  table->move_to(30 * kDegree);
  EXPECT_NEAR(rig.true_angle_rad() - start_rad, 30 * kDegree, 1e-12);
  table->home();  // the position is known: no new zero
  EXPECT_NEAR(rig.true_angle_rad(), start_rad, 1e-12);
}

TEST(GrblSettings, ThatWouldMeasureWrongAreRefusedWithWhatToType) {
  const auto refused = [](const std::string& commands, rig::HomeBy home_by = rig::HomeBy::here) {
    Rig rig(Protocol::grbl, home_by);
    rig.port->receive("$X\n" + commands);
    rig.port->transmit();
    return refusal([&] { rig.make_turntable(); });
  };
  EXPECT_THAT(refused("$13=1\n"), HasSubstr("type: $13=0, or let"));
  EXPECT_THAT(refused("$1=25\n"), HasSubstr("type: $1=255, or let"));
  EXPECT_THAT(refused("$22=1\n$20=1\n"), HasSubstr("type: $20=0, or let"));
  EXPECT_THAT(refused("$32=1\n"), HasSubstr("type: $32=0, or let"));
  EXPECT_THAT(refused("$22=0\n", rig::HomeBy::home_switch), HasSubstr("type: $22=1, or let"));
  EXPECT_THAT(refused("$130=200\n", rig::HomeBy::home_switch), HasSubstr("type: $130=360, or let"));
}

TEST(GrblSettings, ReportsInWorkCoordinatesGiveTheSamePosition) {
  Rig rig(Protocol::grbl, rig::HomeBy::home_switch);
  rig.port->receive("$X\n$10=0\nG92 X17\n");
  const auto table = rig.make_turntable();
  table->home();
  table->move_to(30 * kDegree);
  EXPECT_NEAR(rig.true_angle_rad(), 30 * kDegree, 1e-12);
  EXPECT_NEAR(table->angle_rad(), 30 * kDegree, 1e-12);
}

// The first command to turn gets lost, and of the readings that show it the last one has a wrong digit.
TEST(GrblMove, ThatGotLostIsBegunAgainFromWhereThePlatformStands) {
  struct Line final : rig::ByteLine {
    explicit Line(std::unique_ptr<rig::ByteLine> to) : line(std::move(to)) {}
    std::string read(double timeout_s) override {
      std::string bytes = line->read(timeout_s);
      const std::size_t at = bytes.find("Pos:");
      if (asked == 6 && at != std::string::npos) bytes.insert(bytes.find_first_of("0123456789", at), "7");
      return bytes;
    }
    void write(std::string_view bytes) override {
      const bool moves = bytes.find("G1") != std::string_view::npos;
      asked = moves && asked < 0 ? 0 : asked + (asked >= 0 && bytes == "?");
      if (!moves || asked != 0) line->write(bytes);
    }
    std::unique_ptr<rig::ByteLine> line;
    int asked = -1;  // since the command that got lost
  };
  Rig rig(Protocol::grbl);
  rig.open_line = [&] { return std::make_unique<Line>(rig::open_simulated_line(rig.port, rig.clock)); };
  const auto table = rig.make_turntable();
  table->home();
  double largest_rad = 0;
  std::function<void()> watch = [&] {
    largest_rad = std::max(largest_rad, std::abs(rig.true_angle_rad()));
    rig.clock.plan(0, watch);
  };
  rig.clock.plan(0, watch);
  table->move_to(30 * kDegree);
  rig.clock.plan(0, [] {});
  EXPECT_NEAR(rig.true_angle_rad(), 30 * kDegree, 1e-12);
  EXPECT_LT(largest_rad, 31 * kDegree);
}

// A controller that stands and has said nothing of homing did not hear of it, or its ok got lost.
TEST(GrblHoming, WhoseCommandGotLostIsBegunAgain) {
  for (const Protocol protocol : {Protocol::grbl, Protocol::documented_grbl}) {
    Rig rig(protocol);
    int homings = 0;
    struct Line final : rig::ByteLine {
      Line(std::unique_ptr<rig::ByteLine> to, int& counted) : line(std::move(to)), homings(counted) {}
      std::string read(double timeout_s) override { return line->read(timeout_s); }
      void write(std::string_view bytes) override {
        if (bytes.find("$H") == std::string_view::npos || ++homings > 1) line->write(bytes);
      }
      std::unique_ptr<rig::ByteLine> line;
      int& homings;
    };
    rig.open_line = [&] { return std::make_unique<Line>(rig::open_simulated_line(rig.port, rig.clock), homings); };
    const auto table = rig.make_turntable();
    table->home();
    EXPECT_EQ(homings, 2) << protocol;
    EXPECT_NEAR(rig.true_angle_rad(), 0, 1e-12) << protocol;
  }
}

namespace {

struct Heard {
  int at_operation = 0;  // the first `command`
  int after_stop = 0;    // so many more of them
};

// Homes and turns a stage that is stopped while the answer to the first `command` is awaited.
Heard heard_of(const std::string& command, const rig::LineFaultPlan& faults) {
  Rig rig(Protocol::zaber, rig::HomeBy::home_switch, faults);
  Heard heard;
  bool stopped = false;
  std::unique_ptr<rig::Turntable> table;
  const auto before_write = [&](std::string_view bytes) {
    if (bytes.find(command) == std::string_view::npos) return;
    heard.after_stop += stopped;
    if (std::exchange(heard.at_operation, rig.port->operations() + 1) != 0) return;
    rig.clock.plan(0, [&] {
      table->stop();
      stopped = true;
    });
  };
  rig.open_line = [&] {
    return std::make_unique<WatchedLine>(rig::open_simulated_line(rig.port, rig.clock), before_write);
  };
  table = rig.make_turntable();
  EXPECT_THAT(refusal([&] {
                table->home();
                table->move_to(90 * kDegree);
              }),
              HasSubstr("was stopped"));
  return heard;
}

}  // namespace

// A program that is killed between the command and the stop behind it would leave a stage that turns unattended.
TEST(ZaberStop, ACommandThatGotNoAnswerIsNotRepeatedAfterAStop) {
  for (const std::string command : {"home", "move abs"}) {
    const int at = heard_of(command, {}).at_operation;
    EXPECT_EQ(heard_of(command, {{.at_operation = at, .fault = rig::LineFault::lost_reply}}).after_stop, 0) << command;
  }
}

// A late "ok" of something else says that homing has ended; a stop must not be the one that homing ignores.
TEST(GrblStop, StopsAHomingThatSeemedToHaveEnded) {
  Rig rig(Protocol::grbl);
  struct FalseOk final : rig::ByteLine {
    explicit FalseOk(std::unique_ptr<rig::ByteLine> to) : line(std::move(to)) {}
    std::string read(double timeout_s) override {
      return homes && !std::exchange(said, true) ? "ok\r\n" : line->read(timeout_s);
    }
    void write(std::string_view bytes) override {
      homes = homes || bytes.find("$H") != std::string_view::npos;
      line->write(bytes);
    }
    std::unique_ptr<rig::ByteLine> line;
    bool homes = false, said = false;
  };
  rig.open_line = [&] { return std::make_unique<FalseOk>(rig::open_simulated_line(rig.port, rig.clock)); };
  const auto table = rig.make_turntable();
  double told_rad = 0;
  rig.clock.plan(0.5, [&] {
    rig.port->transmit();
    told_rad = rig.true_angle_rad();
    table->stop();
  });
  EXPECT_THAT(refusal([&] { table->home(); }), HasSubstr("home it again"));
  rig.clock.sleep_s(5);
  rig.port->transmit();
  EXPECT_LT(told_rad, 50 * kDegree);
  EXPECT_NEAR(rig.true_angle_rad(), told_rad, 5 * kDegree);
}

// 120 deg/s, which takes 12 degrees to stand; 31.7 deg/s are 2080 of the stage's units.
TEST(ZaberSetup, AHomingThatIsTooFastToStopIsRefusedWithTheLineToType) {
  Rig rig(Protocol::zaber, rig::HomeBy::home_switch, {}, 120);
  rig.port->receive("/1 1 set limit.approach.maxspeed 100000\n");
  const std::string said = refusal([&] { rig.make_turntable(); });
  EXPECT_THAT(said, testing::AllOf(HasSubstr("looks for its home at 119.99"), HasSubstr("too fast"),
                                   HasSubstr("send \"set limit.approach.maxspeed 2080\"")));
  rig.port->receive("/1 1 set limit.approach.maxspeed 2080\n");
  rig.make_turntable()->home();
  EXPECT_NEAR(rig.true_angle_rad(), 0, 1e-12);
}

TEST(ZaberSetup, NeedsTheStagesOwnHome) {
  Rig rig(Protocol::zaber, rig::HomeBy::here);
  EXPECT_THAT(refusal([&] { rig.make_turntable(); }), HasSubstr("\"home\": \"switch\""));
}

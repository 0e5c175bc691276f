// Each fault at each operation of a short piece of work: the work ends right, or with a message and a turntable that
// works again once it is homed. It never ends wrong.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <iostream>
#include <set>

#include "tests/rig/turntables/wired_bench.h"

namespace {

using rig::kDegree;
using testing::AnyOf;
using testing::Each;
using testing::HasSubstr;

using Rig = WiredBench<EventfulClock>;

struct Ending {
  std::string message;  // empty: it was done
  double took_s = 0;    // on the rig's clock, until the message
};

void work(rig::Turntable& table) {
  table.home();
  table.move_to(30 * kDegree);
  table.move_to(-15 * kDegree);
}

// Begins with the connection; the table may not have come about.
Ending try_work(Rig& rig, std::unique_ptr<rig::Turntable>& table) {
  try {
    table = rig.make_turntable();
    work(*table);
    EXPECT_NEAR(table->angle_rad(), -15 * kDegree, 1e-12);
    EXPECT_NEAR(rig.off_rad(-15 * kDegree), 0, 1e-12);
    EXPECT_EQ(table->state(), rig::TurntableState::idle);
    return {};
  } catch (const std::exception& error) {
    return {error.what(), rig.clock.monotonic_s()};
  }
}

void come_back(Rig& rig) {
  rig.port->power_on();
}

// By its serial number it is found there.
void come_back_at_another_port(Rig& rig) {
  rig.power_on_another();
}

void expect_sound_again(Rig& rig, std::unique_ptr<rig::Turntable>& table) {
  if (table) {
    EXPECT_EQ(table->state(), rig::TurntableState::unknown_position);
    EXPECT_THROW(table->move_to(0), std::runtime_error);
    work(*table);
  } else {
    table = rig.make_turntable();
    work(*table);
  }
  EXPECT_NEAR(rig.off_rad(-15 * kDegree), 0, 1e-12);
}

constexpr double kHomingTimeoutS = 30;  // a turn at 15 deg/s, and the search for the switch's edge

struct LineFaults : testing::TestWithParam<Protocol> {
  // Sweeps over the operations of the work without faults; returns what was said.
  std::set<std::string> sweep(rig::LineFault fault, double most_s,
                              const std::function<void(Rig&)>& put_right = come_back) {
    Rig sound(GetParam());
    std::unique_ptr<rig::Turntable> table;
    EXPECT_EQ(try_work(sound, table).message, "");
    const int operations = sound.port->operations();
    const double sound_s = sound.clock.monotonic_s();
    EXPECT_GT(operations, 50);
    std::set<std::string> said;
    int failed = 0;
    for (int at = 1; at <= operations; ++at) {
      SCOPED_TRACE("at operation " + std::to_string(at));
      Rig rig(GetParam(), rig::HomeBy::home_switch, {{.at_operation = at, .fault = fault}});
      rig.stepper.move_timeout_s = kHomingTimeoutS;
      std::unique_ptr<rig::Turntable> faulty;
      const Ending ending = try_work(rig, faulty);
      if (!ending.message.empty()) {
        ++failed;
        said.insert(ending.message);
        EXPECT_LT(ending.took_s, sound_s + most_s);
        put_right(rig);
        expect_sound_again(rig, faulty);
      }
    }
    std::cout << GetParam() << ", " << operations << " operations, " << failed << " ended with a message:\n";
    for (const std::string& message : said) std::cout << "  " << message << "\n";
    return said;
  }
};

INSTANTIATE_TEST_SUITE_P(OverTheWire, LineFaults,
                         testing::Values(Protocol::grbl, Protocol::documented_grbl, Protocol::zaber),
                         testing::PrintToStringParamName());

}  // namespace

TEST_P(LineFaults, ALostAnswerIsAskedForAgain) {
  EXPECT_THAT(sweep(rig::LineFault::lost_reply, 0), testing::IsEmpty());
}

TEST_P(LineFaults, NoiseBeforeAnAnswerIsPassedOver) {
  EXPECT_THAT(sweep(rig::LineFault::garbage, 0), testing::IsEmpty());
}

TEST_P(LineFaults, AWrongDigitOfAPositionIsNotBelieved) {
  EXPECT_THAT(sweep(rig::LineFault::wrong_digit, 0), testing::IsEmpty());
}

TEST_P(LineFaults, AnAnswerThatRunsIntoTheNextOneIsNoFalseOk) {
  EXPECT_THAT(sweep(rig::LineFault::glued, 0), testing::IsEmpty());
}

TEST_P(LineFaults, AnAnswerInHalvesIsPutTogether) {
  EXPECT_THAT(sweep(rig::LineFault::split, 0), testing::IsEmpty());
}

TEST_P(LineFaults, ALateAnswerIsNotTakenForTheNextOne) {
  EXPECT_THAT(sweep(rig::LineFault::late, 0), testing::IsEmpty());
}

TEST_P(LineFaults, ARepeatedAnswerIsNotTakenForTheNextOne) {
  EXPECT_THAT(sweep(rig::LineFault::repeated, 0), testing::IsEmpty());
}

TEST_P(LineFaults, SilenceIsSaidAfterAWhileAndThePositionIsUnknown) {
  const auto said = sweep(rig::LineFault::silence, kHomingTimeoutS);
  EXPECT_THAT(said, testing::Not(testing::IsEmpty()));
  EXPECT_THAT(said, Each(AnyOf(HasSubstr("did not answer; "), HasSubstr("said nothing; "),
                               HasSubstr("has not come to rest within"))));
}

TEST_P(LineFaults, AControllerThatStartsAnewIsNoticedAndHasToBeHomed) {
  const auto said = sweep(rig::LineFault::reset, 10);
  EXPECT_THAT(said, testing::Not(testing::IsEmpty()));
  // The last one: it takes longer to start than it is asked for.
  EXPECT_THAT(said, Each(AnyOf(HasSubstr("started anew"), HasSubstr("does not know where it is"),
                               HasSubstr("its cable may be loose or its power off"))));
}

TEST_P(LineFaults, AnAlarmIsSaidInWordsAndHasToBeHomed) {
  const auto said = sweep(rig::LineFault::alarm, 10);
  EXPECT_THAT(said, testing::Not(testing::IsEmpty()));
  EXPECT_THAT(said, Each(AnyOf(HasSubstr("end switch"), HasSubstr("stalled"))));
}

TEST_P(LineFaults, AnUnpluggedCableIsSaidWithinASecondAndIsNoTimeout) {
  const auto said = sweep(rig::LineFault::unplug, 1);
  EXPECT_THAT(said, testing::ElementsAre(HasSubstr("was unplugged or switched off; plug it in")));
}

TEST_P(LineFaults, ADeviceThatComesBackAtAnotherPortIsFoundThere) {
  const auto said = sweep(rig::LineFault::unplug, 1, come_back_at_another_port);
  EXPECT_THAT(said, testing::ElementsAre(HasSubstr("was unplugged or switched off; plug it in")));
}

// From the Nth command on somebody else sits at the port.
TEST_P(LineFaults, AnotherDeviceOnThePortIsRefused) {
  const auto said = sweep(rig::LineFault::wrong_device, kHomingTimeoutS);
  EXPECT_THAT(said, testing::Not(testing::IsEmpty()));
  EXPECT_THAT(said, Each(AnyOf(HasSubstr("choose the turntable's port"), HasSubstr("did not answer; "),
                               HasSubstr("has not come to rest within"))));
}

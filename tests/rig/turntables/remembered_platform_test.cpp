// A platform without a home switch: what the next program knows of where the last one left it.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "rig/devices/device_contract.h"
#include "tests/rig/turntables/ended_program.h"
#include "tests/rig/turntables/wired_bench.h"
#include "tests/support/refusal.h"

namespace {

using rig::kDegree;
using testing::AllOf;
using testing::HasSubstr;

using Rig = WiredBench<EventfulClock>;

// A platform without a home switch, whose mark is at the bench's true angle 0.
struct RememberedPlatform : testing::TestWithParam<Protocol> {
  RememberedPlatform() {
    rig.stepper.memory = memory;
    rig.bench.turn_platform(0);
    rig.power_on_another();
    rig.make_turntable()->home();
  }
  // A line whose opening does not reset the board.
  void keep_board_running() {
    rig.open_line = [this] {
      struct Line final : rig::ByteLine {
        Line(std::shared_ptr<rig::SimulatedPort> to, rig::Clock& by) : port(std::move(to)), clock(by) {}
        std::string read(double timeout_s) override {
          const double until_s = clock.monotonic_s() + timeout_s;
          std::string bytes = port->transmit();
          for (; bytes.empty() && clock.monotonic_s() < until_s; bytes = port->transmit()) clock.sleep_s(0.01);
          return bytes;
        }
        void write(std::string_view bytes) override { port->receive(bytes); }
        std::shared_ptr<rig::SimulatedPort> port;
        rig::Clock& clock;
      };
      return std::make_unique<Line>(rig.port, rig.clock);
    };
  }

  std::shared_ptr<Memory> memory = std::make_shared<Memory>();
  Rig rig{GetParam(), rig::HomeBy::here};
};

INSTANTIATE_TEST_SUITE_P(OverTheWire, RememberedPlatform, testing::Values(Protocol::grbl, Protocol::documented_grbl),
                         testing::PrintToStringParamName());

}  // namespace

TEST_P(RememberedPlatform, IsTurnedBackByTheNextProgramFromWhereItWasLeft) {
  for (const double left_deg : {45.0, -200.0, 0.025}) {
    const auto table = rig.make_turntable();
    table->home();
    table->move_to(left_deg * kDegree);
    rig.power_on_another();
    const auto next = rig.make_turntable();
    next->home();
    EXPECT_NEAR(rig.true_angle_rad(), 0, 1e-12) << left_deg;
    EXPECT_EQ(next->angle_rad(), 0);
  }
  EXPECT_EQ(memory->asked, 0);
}

TEST_P(RememberedPlatform, IsKnownAfterAStop) {
  const auto table = rig.make_turntable();
  table->home();
  rig.clock.plan(1, [&] { table->stop(); });
  EXPECT_THAT(refusal([&] { table->move_to(90 * kDegree); }), HasSubstr("was stopped at"));
  EXPECT_GT(rig.true_angle_rad(), 10 * kDegree);
  rig.power_on_another();
  rig.make_turntable()->home();
  EXPECT_NEAR(rig.true_angle_rad(), 0, 1e-12);
}

TEST_P(RememberedPlatform, IsAskedForWhenItsProgramWasKilledAndItsBoardReset) {
  memory->place = {.steps = 0, .angle_rad = 0, .turning = true};
  rig.bench.turn_platform(70 * kDegree);
  rig.power_on_another();
  EXPECT_THAT(refusal([&] { rig.make_turntable()->home(); }), HasSubstr("threadstation home --mark"));
  EXPECT_NEAR(rig.true_angle_rad(), 70 * kDegree, 1e-12) << "nothing turns before the place is known";
  memory->turn_to_mark = [this] {
    rig.bench.turn_platform(0);
    rig.power_on_another();
  };
  memory->turn_to_mark();
  const auto table = rig.make_turntable();
  memory->turn_to_mark = [] {};
  table->home();
  EXPECT_EQ(table->angle_rad(), 0);
  EXPECT_EQ(memory->asked, 2);
}

TEST_P(RememberedPlatform, IsCountedByABoardThatWasNotReset) {
  keep_board_running();
  {
    const auto table = rig.make_turntable();
    table->home();
    table->move_to(30 * kDegree);
    table->move_to(50 * kDegree);
  }
  memory->place->turning = true;  // killed on the way from 50 deg: the board counted on
  rig.port->receive("G90 G53 G1 X80 F600\n");
  rig.clock.sleep_s(10);
  const auto next = rig.make_turntable();
  next->home();
  EXPECT_NEAR(rig.true_angle_rad(), 0, 1e-12);
  EXPECT_EQ(memory->asked, 0);
}

// Somebody else's program turned it, or its board was reset and then turned.
TEST_P(RememberedPlatform, IsAskedForWhenItsControllerCountsOtherwise) {
  keep_board_running();
  rig.make_turntable()->home();
  rig.port->receive("G90 G53 G1 X80 F600\n");
  rig.clock.sleep_s(10);
  EXPECT_THAT(refusal([&] { rig.make_turntable()->home(); }),
              AllOf(HasSubstr("counts otherwise"), HasSubstr("threadstation home --mark")));
  EXPECT_EQ(memory->asked, 1);
}

TEST_P(RememberedPlatform, TakesAMeasuredAngleForItsOwn) {
  const auto table = rig.make_turntable();
  table->home();
  rig.bench.turn_platform(20 * kDegree);  // by hand
  rig.power_on_another();
  const auto next = rig.make_turntable();
  next->home();
  EXPECT_EQ(next->angle_rad(), 0);
  next->stands_at(20 * kDegree);
  EXPECT_NEAR(next->angle_rad(), 20 * kDegree, 1e-12);
  next->move_to(0);
  EXPECT_NEAR(rig.true_angle_rad(), 0, 1e-12);
}

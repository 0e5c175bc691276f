// What the driver says about boards as people have them, with the settings and the homing that GRBL comes with.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "rig/turntables/grbl_settings.h"
#include "tests/rig/turntables/documented_bench.h"
#include "tests/rig/turntables/ended_program.h"
#include "tests/support/refusal.h"

namespace {

using rig::kDegree;
using testing::AllOf;
using testing::HasSubstr;

}  // namespace

TEST(DocumentedTurntable, FindsItsHomeFromAnywhere) {
  for (double stands_at_deg = -360; stands_at_deg < 360; stands_at_deg += 36.5) {
    auto options = DocumentedBench::right();
    options.stands_at_deg = stands_at_deg;
    DocumentedBench bench(options);
    bench.make_turntable()->home();
    EXPECT_NEAR(std::remainder(bench.board.platform_deg() - 1, 360), 0, 1e-9) << stands_at_deg;
  }
}

TEST(DocumentedTurntable, AsItComesIsRefusedAtOnceWithAllThatMustDiffer) {
  DocumentedBench bench(DocumentedBench::as_it_comes());
  const std::string said = refusal([&] { bench.make_turntable(); });
  EXPECT_THAT(said, AllOf(HasSubstr("type: $1=255, $22=1, $25=480, $100=40, $130=360"), HasSubstr("homes Z first"),
                          testing::Not(HasSubstr("alarm"))));
  EXPECT_THAT(bench.board.log(), testing::IsEmpty());
}

TEST(DocumentedTurntable, ThatHomesZFirstIsRefusedBeforeItTurns) {
  auto options = DocumentedBench::right();
  options.homes_single_axis = false;
  DocumentedBench bench(options);
  EXPECT_THAT(refusal([&] { bench.make_turntable()->home(); }),
              AllOf(HasSubstr("homes Z first"), HasSubstr("\"homing_cycle\": \"x_only\"")));
  EXPECT_THAT(bench.board.log(), testing::IsEmpty());
}

TEST(DocumentedTurntable, ThatWasBuiltToHomeXAloneIsHomedWhenTheRigFileSaysSo) {
  auto options = DocumentedBench::right();
  options.homes_single_axis = false;
  options.homing = DocumentedGrblOptions::Homing::x_only;
  DocumentedBench bench(options);
  bench.setup.homes_x_alone = true;
  bench.make_turntable()->home();
  EXPECT_NEAR(bench.at_rad(), 0, 1e-9);
}

TEST(DocumentedTurntable, WhoseTravelIsTooShortIsRefusedBeforeItTurns) {
  DocumentedBench bench(DocumentedBench::right(), {{130, 200}});
  EXPECT_THAT(refusal([&] { bench.make_turntable()->home(); }), HasSubstr("type: $130=360, or let"));
  EXPECT_THAT(bench.board.log(), testing::IsEmpty());
}

TEST(DocumentedTurntable, SaysItsAlarmsInWords) {
  auto without = DocumentedBench::right();
  without.switch_deg.reset();
  DocumentedBench lost(without);
  EXPECT_THAT(refusal([&] { lost.make_turntable()->home(); }), HasSubstr("alarm 9: it found no home switch"));
  auto stuck = DocumentedBench::right();
  stuck.switch_width_deg = 350;
  DocumentedBench pressed(stuck);
  EXPECT_THAT(refusal([&] { pressed.make_turntable()->home(); }), HasSubstr("alarm 8"));
}

TEST(DocumentedTurntable, ThatLosesItsPowerInAMoveHasToBeHomed) {
  DocumentedBench bench;
  const auto table = bench.make_turntable();
  table->home();
  bench.clock.plan(1, [&] {
    bench.board.unplug();
    bench.board.plug_in();
  });
  EXPECT_THAT(refusal([&] { table->move_to(90 * kDegree); }), HasSubstr("started anew"));
  table->home();
  EXPECT_NEAR(std::remainder(bench.board.platform_deg() - 1, 360), 0, 1e-9);
}

TEST(DocumentedTurntable, WithoutASwitchIsHomeWhereItStands) {
  DocumentedBench bench(DocumentedBench::as_it_comes(), {{1, 255}, {100, 40}, {110, 1800}, {120, 150}});
  bench.setup.home_by = bench.stepper.home_by = rig::HomeBy::here;
  const auto table = bench.make_turntable();
  table->home();
  table->move_to(30 * kDegree);
  EXPECT_NEAR(bench.board.platform_deg(), 80, 1e-9);
}

namespace {

// A board without a home switch that its port does not reset, with its mark where it stands.
struct KeptBoard : DocumentedBench {
  static DocumentedGrblOptions options() {
    auto options = as_it_comes();
    options.resets_when_opened = false;
    return options;
  }
  KeptBoard() : DocumentedBench(options(), {{1, 255}, {100, 40}, {110, 1800}, {120, 150}}) {
    setup.home_by = stepper.home_by = rig::HomeBy::here;
    stepper.memory = memory;
  }
  std::unique_ptr<rig::Turntable> make_turntable() {
    return rig::make_stepper_turntable(
        [this] { return rig::connect_grbl(std::make_unique<MortalLine>(board.open(), clock, killed), clock, setup); },
        clock, stepper);
  }
  // Kills the program in a move; the platform turns on for as long as its leash is.
  void kill_on_the_way() {
    auto table = make_turntable();
    table->home();
    clock.plan(2, [this] {
      killed = true;
      throw std::runtime_error("killed");
    });
    EXPECT_THAT(refusal([&] { table->move_to(90 * kDegree); }), HasSubstr("killed"));
    table.reset();
    EXPECT_TRUE(board.turning());
    killed = false;
  }
  std::shared_ptr<Memory> memory = std::make_shared<Memory>();
  std::atomic<bool> killed = false;
};

}  // namespace

TEST(DocumentedTurntable, ThatAKilledProgramLeftTurningIsHeldBeforeItsResetAndTurnedBack) {
  KeptBoard bench;
  bench.kill_on_the_way();
  bench.make_turntable()->home();
  EXPECT_NEAR(bench.board.platform_deg(), 50, 1e-9);
  EXPECT_EQ(bench.memory->asked, 0);
}

// Something else than this program has reset it meanwhile.
TEST(DocumentedTurntable, WhoseCountAnAlarmHasSpoiltIsNotBelieved) {
  KeptBoard bench;
  bench.kill_on_the_way();
  bench.board.open()->write("\x18");
  EXPECT_THAT(refusal([&] { bench.make_turntable()->home(); }),
              AllOf(HasSubstr("reported an alarm"), HasSubstr("threadstation home --mark")));
  bench.memory->turn_to_mark = [] {};
  bench.make_turntable()->home();  // the alarm was cleared, the place is still lost
  EXPECT_EQ(bench.memory->asked, 2);
}

TEST(DocumentedTurntable, IsSetUpWithWhatItNeeds) {
  DocumentedBench bench(DocumentedBench::as_it_comes());
  {
    const auto port = rig::connect_grbl_settings(bench.board.open(), bench.clock, bench.setup);
    for (const auto& row : rig::grbl_setting_rows(port->read_settings(), bench.setup, port->firmware()))
      if (row.needed) port->write_setting(row.number, *row.needed);
  }
  bench.setup.homes_x_alone = true;
  bench.make_turntable();
  EXPECT_EQ(bench.board.settings().at(130), 360);
  EXPECT_EQ(bench.board.settings().at(1), 255);
}

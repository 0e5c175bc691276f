// Setting up a turntable's controller, on a board with the settings that it comes with.
#include "station/bench/turntable_set_up.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <functional>

#include "station/documents/turntable_settings_file.h"
#include "tests/support/documented_grbl.h"
#include "tests/support/refusal.h"

namespace {

using namespace station;
using testing::HasSubstr;

struct TurntableSetUp : testing::Test {
  TurntableSetUp() {
    std::string name = std::filesystem::temp_directory_path() / "setupXXXXXX";
    folder = mkdtemp(name.data());
    setup.steps_per_deg = 44.4;
    setup.home_by = rig::HomeBy::home_switch;
  }
  ~TurntableSetUp() override { std::filesystem::remove_all(folder); }
  SetUpReport set_up(const SetUpRequest& request) {
    const auto port = rig::connect_grbl_settings(board.open(), clock, setup);
    return set_up_turntable(*port, setup, request);
  }

  std::filesystem::path folder;
  rig::SimulatedClock clock{1.8e9};
  DocumentedGrbl board{clock};
  rig::ControllerSetup setup;
  std::map<int, double> former = board.settings();
};

}  // namespace

TEST_F(TurntableSetUp, ShowsWhatDiffersAndChangesNothing) {
  const SetUpReport report = set_up({});
  std::map<int, double> needed;
  for (const SetUpRow& row : report.rows) {
    EXPECT_FALSE(row.after);
    EXPECT_FALSE(row.meaning.empty());
    if (row.needed) needed[row.number] = *row.needed;
  }
  EXPECT_EQ(needed, (std::map<int, double>{{1, 255}, {22, 1}, {25, 480}, {100, 44.4}, {130, 360}}));
  EXPECT_THAT(report.homing_problem, HasSubstr("homes Z first"));
  EXPECT_EQ(board.settings(), former);
}

TEST_F(TurntableSetUp, WritesWhatDiffersAndPutsItBack) {
  const std::filesystem::path back_up = folder / "before.json";
  const SetUpReport written = set_up({.write = true, .back_up = back_up, .restore = {}});
  std::map<int, double> right = former;
  for (const auto& [number, value] : std::map<int, double>{{1, 255}, {22, 1}, {25, 480}, {100, 44.4}, {130, 360}})
    right[number] = value;
  EXPECT_EQ(board.settings(), right);
  for (const SetUpRow& row : written.rows) EXPECT_EQ(row.after.has_value(), row.needed.has_value()) << row.number;
  EXPECT_EQ(read_turntable_settings(back_up).settings, former);
  for (const SetUpRow& row : set_up({}).rows) EXPECT_FALSE(row.needed) << row.number;
  const SetUpReport restored = set_up({.write = false, .back_up = {}, .restore = back_up});
  EXPECT_EQ(board.settings(), former);
  EXPECT_EQ(std::ranges::count_if(restored.rows, [](const SetUpRow& row) { return row.after.has_value(); }), 5);
}

TEST_F(TurntableSetUp, PutsSoftLimitsBackAfterTheHomingThatTheyNeed) {
  const std::filesystem::path back_up = folder / "before.json";
  std::map<int, double> soft = former;
  soft[20] = soft[22] = 1;
  write_json_file(back_up, to_json(TurntableSettings{"Grbl 1.1h ['$' for help]", soft}));
  set_up({.write = false, .back_up = {}, .restore = back_up});
  EXPECT_EQ(board.settings(), soft);
}

TEST_F(TurntableSetUp, RefusesWhatCannotBeMeantInOneLine) {
  const std::filesystem::path back_up = folder / "before.json";
  EXPECT_THAT(refusal([&] { set_up({.write = true, .back_up = {}, .restore = {}}); }), HasSubstr("--back-up FILE"));
  EXPECT_THAT(refusal([&] { set_up({.write = true, .back_up = {}, .restore = back_up}); }), HasSubstr("exclude"));
  EXPECT_THAT(refusal([&] { set_up({.write = false, .back_up = back_up, .restore = {}}); }),
              HasSubstr("goes with --write"));
  EXPECT_THAT(refusal([&] { set_up({.write = false, .back_up = {}, .restore = back_up}); }), HasSubstr("before.json"));
  write_json_file(back_up, to_json(TurntableSettings{"Grbl 1.1f ['$' for help]", former}));
  EXPECT_THAT(refusal([&] { set_up({.write = true, .back_up = back_up, .restore = {}}); }),
              HasSubstr("exists already"));
  EXPECT_THAT(refusal([&] { set_up({.write = false, .back_up = {}, .restore = back_up}); }),
              HasSubstr("of another controller"));
  EXPECT_THAT(refusal([&] { set_up({.write = true, .back_up = folder / "none" / "before.json", .restore = {}}); }),
              HasSubstr("before.json"));
  EXPECT_EQ(board.settings(), former);
}

// A controller that takes a setting and does not keep it, as some boards' makers lock them.
TEST_F(TurntableSetUp, SaysThatASettingIsNotKept) {
  struct Locked final : rig::GrblSettingsPort {
    rig::GrblFirmware firmware() override { return rig::grbl_firmware("Grbl 1.1h ['$' for help]", {"OPT:VH,15,128"}); }
    rig::GrblSettings read_settings() override { return {{1, 25}, {100, 44.4}, {130, 360}, {22, 1}}; }
    void write_setting(int, double) override {}
  } locked;
  EXPECT_THAT(refusal([&] {
                set_up_turntable(locked, setup, {.write = true, .back_up = folder / "before.json", .restore = {}});
              }),
              HasSubstr("was told $1=255 and has $1=25"));
}

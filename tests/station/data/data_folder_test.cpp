// Where the program looks for what comes with it.
#include "station/data/data_folder.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>

#include "tests/places.h"
#include "tests/station/commands/program.h"
#include "tests/support/message_of.h"

namespace station {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;

struct DataFolder : testing::Test {
  DataFolder() { ::unsetenv("THREADSTATION_DATA"); }
  ~DataFolder() override { ::unsetenv("THREADSTATION_DATA"); }
  static void name(const fs::path& folder) { ::setenv("THREADSTATION_DATA", folder.c_str(), 1); }
  const station_test::TemporaryFolder folder_;
};

TEST_F(DataFolder, OfAProgramThatWasBuiltIsThatOfItsCheckout) {
  EXPECT_TRUE(fs::equivalent(data_folder(), DATA_DIR)) << data_folder();
  EXPECT_EQ(data_folder_name(), data_folder());
}

TEST_F(DataFolder, IsTheOneThatTheEnvironmentNames) {
  fs::create_directories(folder_ / "rigs");
  name(folder_.path());
  EXPECT_EQ(data_folder(), folder_.path());
  EXPECT_EQ(data_folder_name(), folder_.path());
}

TEST_F(DataFolder, ThatTheEnvironmentNamesAndIsNotThereGetsOneLine) {
  name(folder_ / "none");
  EXPECT_THAT(message_of([] { data_folder(); }),
              AllOf(HasSubstr("THREADSTATION_DATA"), HasSubstr(folder_ / "none"), HasSubstr("leave it out")));
  EXPECT_EQ(data_folder_name(), folder_ / "none");
}

// An empty variable is what shells leave of one that was cleared.
TEST_F(DataFolder, IsNotNamedByAnEmptyVariable) {
  name("");
  EXPECT_TRUE(fs::equivalent(data_folder(), DATA_DIR));
}

// A copy of the program in another folder, and in none that has data beside it or above.
TEST_F(DataFolder, IsFoundFromTheProgramsOwnPlace) {
  const fs::path program = folder_ / "opt/bin/threadstation", data = folder_ / "opt/share/threadstation";
  fs::create_directories(program.parent_path());
  fs::copy_file(THREADSTATION_PROGRAM, program);
  const std::string line =
      "cd / && '" + program.string() + "' demo --quick --out '" + (folder_ / "demo").string() + "'";
  const station_test::ProgramResult without = station_test::run_shell(line);
  EXPECT_EQ(without.status, 1);
  EXPECT_THAT(without.error, AllOf(HasSubstr("share/threadstation"), HasSubstr("THREADSTATION_DATA")));
  EXPECT_EQ(without.error_lines(), 1) << without.error;
  // A page that nobody could use does not come up.
  const station_test::ProgramResult serve = station_test::run_shell(
      "cd / && timeout 20 '" + program.string() +
      "' serve --port 0 --rig '" DATA_DIR "/rigs/simulated.json' --workspace '" + (folder_ / "lab").string() + "'");
  EXPECT_EQ(serve.status, 1);
  EXPECT_THAT(serve.error, HasSubstr("share/threadstation"));
  fs::create_directories(data / "rigs");  // found, and then its rig is missed
  EXPECT_THAT(station_test::run_shell(line).error, HasSubstr(data / "rigs/simulated.json"));
}

}  // namespace
}  // namespace station

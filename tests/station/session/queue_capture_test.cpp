// capture --queue as a technician runs it, on the simulated bench with a sensor so coarse that drawing hardly counts.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>

#include <chrono>
#include <filesystem>
#include <fstream>
#include <thread>

#include "rig/devices/clock.h"
#include "station/documents/reader.h"
#include "tests/places.h"
#include "tests/station/commands/program.h"
#include "tests/station/session/hasty_bench.h"

namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using station_test::ProgramResult;
using station_test::run_threadstation;
using testing::HasSubstr;

std::string fixture(const std::string& name) {
  return std::string(FIXTURES_DIR) + "/" + name + ".json";
}

struct QueueCapture : testing::Test {
  QueueCapture() {
    json calibration = station_test::hasty_calibration(station::read_json_file(fixture("calibrations/simulated")));
    calibration["utc"] = rig::SystemClock().utc();  // it must not be too old
    fs::create_directory(folder / "calibration");
    station::write_json_file(folder / "calibration/calibration.json", calibration);
    station::write_json_file(folder / "rig.json",
                             station_test::hasty_rig(station::read_json_file(fixture("rigs/simulated"))));
  }
  void write_queue(const std::string& second_spool) const {
    std::ofstream(folder / "spools.csv") << "barcode,lot,material,note,spool\n"
                                         << "4711,A 1,silk,\"left shelf, top\"," << fixture("spools/silk_red") << "\n"
                                         << "4712,,,," << second_spool << "\n"
                                         << "4713,,,," << fixture("spools/silk_blue") << "\n";
  }
  std::vector<std::string> arguments() const {
    return {"capture",
            "--rig",
            folder / "rig.json",
            "--calibration",
            folder / "calibration",
            "--queue",
            folder / "spools.csv",
            "--out",
            folder / "lab",
            "--unattended",
            "--quiet",
            "--operator",
            "Ada"};
  }
  bool verifies(const char* session) const {
    return run_threadstation({"verify", folder / "lab" / session}).status == 0;
  }

  struct Lab : station_test::TemporaryFolder {
    fs::path operator/(const fs::path& name) const { return path() / name; }
  } folder;
};

TEST_F(QueueCapture, TakesEverySpoolSaysWhichFailedAndGoesOnFromThere) {
  write_queue(folder / "nowhere.json");
  const ProgramResult first = run_threadstation(arguments());
  EXPECT_EQ(first.status, 1);
  EXPECT_EQ(first.error_lines(), 1) << first.error;
  EXPECT_THAT(first.error, HasSubstr("nowhere.json"));
  EXPECT_THAT(first.error, HasSubstr("4712"));
  EXPECT_THAT(first.out, HasSubstr("4711-A-1: captured\n"));
  EXPECT_THAT(first.out, HasSubstr("4713: captured\n")) << "one bad row does not hold up the others";
  EXPECT_TRUE(verifies("4711-A-1"));
  const json session = station::read_json_file(folder / "lab/4711-A-1/session.json");
  EXPECT_EQ(session.at("sample").at("note"), "left shelf, top");
  EXPECT_EQ(session.at("spool").at("material"), "silk");
  EXPECT_EQ(session.at("operator"), "Ada");

  write_queue(fixture("spools/silk_gold"));
  const ProgramResult second = run_threadstation(arguments());
  EXPECT_EQ(second.status, 0) << second.error;
  EXPECT_THAT(second.out, HasSubstr("4711-A-1: was complete already\n4712: captured\n4713: was complete already\n"));
  EXPECT_TRUE(verifies("4712"));
}

TEST_F(QueueCapture, KilledInASpoolItCapturesThatOneToItsEndAndTheRest) {
  write_queue(fixture("spools/silk_gold"));
  const pid_t process = station_test::start_threadstation(arguments());
  const auto pictures = [&] {
    std::error_code none;
    return std::distance(fs::directory_iterator(folder / "lab/4711-A-1/raw", none), fs::directory_iterator());
  };
  while (pictures() < 3) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  ::kill(process, SIGKILL);
  EXPECT_EQ(station_test::wait_for(process), 128 + SIGKILL);
  EXPECT_FALSE(verifies("4711-A-1"));
  const ProgramResult rest = run_threadstation(arguments());
  EXPECT_EQ(rest.status, 0) << rest.error;
  EXPECT_THAT(rest.out, HasSubstr("4711-A-1: captured to its end\n4712: captured\n4713: captured\n"));
  for (const char* session : {"4711-A-1", "4712", "4713"}) EXPECT_TRUE(verifies(session)) << session;
}

}  // namespace

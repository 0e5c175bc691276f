// The ready calibration of the simulated bench, given to every command that takes one.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>

#include "station/documents/reader.h"
#include "tests/places.h"
#include "tests/station/commands/help.h"
#include "tests/station/commands/program.h"

namespace station_test {
namespace {

using nlohmann::json;

const std::string kData = DATA_DIR;
const std::string kCalibration = kData + "/calibrations/simulated.json";

struct ReadyCalibration : testing::Test {
  ReadyCalibration() {
    json document = station::read_json_file(kData + "/rigs/simulated.json");
    document["simulation"]["samples_per_pixel"] = 1;
    document["simulation"]["target_samples_per_pixel"] = 4;
    station::write_json_file(folder / "rig.json", document);
  }
  void run(const Words& words) {
    const ProgramResult result = run_threadstation(words);
    EXPECT_EQ(result.status, 0) << words.front() << ": " << result.error << result.out;
    used.insert(words.front());
  }
  TemporaryFolder folder;
  std::string rig = folder / "rig.json", session = folder / "session";
  std::set<std::string> used;
};

TEST_F(ReadyCalibration, ServesEveryCommandThatTakesACalibrationAndThoseThatFollowOnTheSession) {
  run({"check", "--rig", rig, "--calibration", kCalibration});
  run({"capture", "--rig", rig, "--calibration", kCalibration, "--spool", kData + "/spools/silk_red.json", "--out",
       session, "--unattended", "--quiet", "--record"});
  run({"validate", "--rig", rig, "--calibration", kCalibration, "--spool", kData + "/spools/packed_silk_red_20.json",
       "--out", folder / "validated", "--folds", "0", "--spp", "4", "--model", "thread", "--quiet"});
  const std::string view = session + "/linear/reflection-horizontal-1.exr";
  run({"develop", session, "--quiet"});
  run({"compare", view, view, "--calibration", kCalibration});
  std::set<std::string> calibrated;
  for (const Words& command : every_command())
    if (help_of(command).find("--calibration ") != std::string::npos) calibrated.insert(joined(command));
  EXPECT_THAT(calibrated, testing::Contains("capture")) << "the help is read";
  EXPECT_THAT(used, testing::IsSupersetOf(calibrated)) << "a command that takes a calibration is missing here";

  run({"verify", session});
  run({"replay", session, "--out", folder / "replayed", "--quiet"});
  run({"invert", session, "--paths", "32", "--paths", "64", "--spp", "4", "--quiet"});
  run({"report", session});
}

}  // namespace
}  // namespace station_test

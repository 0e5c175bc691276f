// The ready calibration of the simulated bench, given to every command that takes one.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>
#include <sstream>

#include "station/documents/reader.h"
#include "tests/places.h"
#include "tests/station/commands/program.h"

namespace station_test {
namespace {

using nlohmann::json;
using Words = std::vector<std::string>;

const std::string kFixtures = FIXTURES_DIR;
const std::string kCalibration = kFixtures + "/calibrations/simulated.json";

std::string help_of(Words command) {
  command.emplace_back("--help");
  return run_threadstation(command).out;
}

// Of the program, or of one of its commands.
Words subcommands_of(const Words& command) {
  Words names;
  std::istringstream lines(help_of(command));
  bool listed = false;
  for (std::string line; std::getline(lines, line); listed = listed || line == "Subcommands:") {
    std::istringstream words(line);
    std::string name;
    if (listed && line.starts_with("  ") && !line.starts_with("   ") && words >> name) names.push_back(name);
  }
  return names;
}

// The commands whose help has the option --calibration.
void add_calibrated(const Words& command, std::set<std::string>& found) {
  std::string name;
  for (const std::string& word : command) name += (name.empty() ? "" : " ") + word;
  if (!command.empty() && help_of(command).find("--calibration ") != std::string::npos) found.insert(name);
  for (const std::string& below : subcommands_of(command)) {
    Words deeper = command;
    deeper.push_back(below);
    add_calibrated(deeper, found);
  }
}

struct ReadyCalibration : testing::Test {
  ReadyCalibration() {
    json document = station::read_json_file(kFixtures + "/rigs/simulated.json");
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
  run({"capture", "--rig", rig, "--calibration", kCalibration, "--spool", kFixtures + "/spools/silk_red.json", "--out",
       session, "--unattended", "--quiet", "--record"});
  run({"validate", "--rig", rig, "--calibration", kCalibration, "--spool",
       kFixtures + "/spools/packed_silk_red_20.json", "--out", folder / "validated", "--folds", "0", "--spp", "4",
       "--model", "thread", "--quiet"});
  const std::string view = session + "/linear/reflection-horizontal-1.exr";
  run({"develop", session, "--quiet"});
  run({"compare", view, view, "--calibration", kCalibration});
  std::set<std::string> calibrated;
  add_calibrated({}, calibrated);
  EXPECT_THAT(calibrated, testing::Contains("capture")) << "the help is read";
  EXPECT_THAT(used, testing::IsSupersetOf(calibrated)) << "a command that takes a calibration is missing here";

  run({"verify", session});
  run({"replay", session, "--out", folder / "replayed", "--quiet"});
  run({"invert", session, "--paths", "32", "--paths", "64", "--spp", "4", "--quiet"});
  run({"report", session});
}

}  // namespace
}  // namespace station_test

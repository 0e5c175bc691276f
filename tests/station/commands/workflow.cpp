#include "tests/station/commands/workflow.h"

#include <cstdlib>
#include <filesystem>
#include <memory>

#include "station/documents/reader.h"
#include "tests/places.h"
#include "tests/station/session/hasty_bench.h"

namespace station_test {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

std::unique_ptr<TemporaryFolder> folder;

std::vector<std::string> capture_of(const std::string& spool, const fs::path& rig, const fs::path& calibration,
                                    const fs::path& session) {
  const std::string spool_file = std::string(DATA_DIR) + "/spools/" + spool + ".json";
  return {"capture",  "--rig", rig,     "--calibration", calibration, "--spool",
          spool_file, "--out", session, "--unattended",  "--quiet"};
}

}  // namespace

void expect_success(const ProgramResult& result) {
  EXPECT_EQ(result.status, 0) << result.error;
}

void expect_one_line(const ProgramResult& result, const std::string& must_name) {
  EXPECT_EQ(result.status, 1) << result.error;
  EXPECT_EQ(result.error_lines(), 1) << result.error;
  EXPECT_NE(result.error.find(must_name), std::string::npos) << result.error;
}

void make_calibrated_bench(const fs::path& made) {
  json rig = station::read_json_file(std::string(DATA_DIR) + "/rigs/simulated.json");
  rig["simulation"]["samples_per_pixel"] = 1;
  rig["simulation"]["target_samples_per_pixel"] = 3;
  station::write_json_file(made / "rig.json", rig);
  expect_success(
      run_threadstation({"calibrate", "--rig", made / "rig.json", "--out", made / "calibration", "--quiet"}));
  expect_success(run_threadstation(capture_of("silk_red", made / "rig.json", made / "calibration", made / "session")));
  expect_success(run_threadstation({"develop", made / "session", "--quiet"}));

  station::write_json_file(made / "hasty_rig.json", hasty_rig(rig));
  fs::create_directory(made / "hasty_calibration");
  station::write_json_file(made / "hasty_calibration/calibration.json",
                           hasty_calibration(station::read_json_file(made / "calibration/calibration.json")));
}

void Workflow::SetUpTestSuite() {
  folder = std::make_unique<TemporaryFolder>();
  if (const char* made = std::getenv(kCalibratedBench))
    fs::copy(made, folder->path(), fs::copy_options::recursive);
  else
    make_calibrated_bench(folder->path());
}

void Workflow::TearDownTestSuite() {
  folder.reset();
}

std::string Workflow::path(const std::string& name) {
  return *folder / name;
}

std::vector<std::string> Workflow::capture_arguments(const std::string& session, const std::string& rig,
                                                     const std::string& spool, const std::string& calibration) {
  return capture_of(spool, path(rig), path(calibration), session);
}

std::vector<std::string> Workflow::hasty_capture_arguments(const std::string& session) {
  return capture_arguments(session, "hasty_rig.json", "silk_red", "hasty_calibration");
}

ProgramResult Workflow::capture(const std::string& session) {
  return run_threadstation(capture_arguments(session));
}

}  // namespace station_test

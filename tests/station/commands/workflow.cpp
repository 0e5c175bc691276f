#include "tests/station/commands/workflow.h"

#include <filesystem>
#include <memory>

#include "station/documents/reader.h"
#include "tests/places.h"
#include "tests/station/session/hasty_bench.h"

namespace station_test {
namespace {

using nlohmann::json;

std::unique_ptr<TemporaryFolder> folder;

}  // namespace

void expect_success(const ProgramResult& result) {
  EXPECT_EQ(result.status, 0) << result.error;
}

void expect_one_line(const ProgramResult& result, const std::string& must_name) {
  EXPECT_EQ(result.status, 1) << result.error;
  EXPECT_EQ(result.error_lines(), 1) << result.error;
  EXPECT_NE(result.error.find(must_name), std::string::npos) << result.error;
}

void Workflow::SetUpTestSuite() {
  folder = std::make_unique<TemporaryFolder>();
  json rig = station::read_json_file(std::string(DATA_DIR) + "/rigs/simulated.json");
  rig["simulation"]["samples_per_pixel"] = 1;
  rig["simulation"]["target_samples_per_pixel"] = 4;
  station::write_json_file(path("rig.json"), rig);
  expect_success(run_threadstation({"calibrate", "--rig", path("rig.json"), "--out", path("calibration"), "--quiet"}));
  expect_success(capture(path("session")));
  expect_success(run_threadstation({"develop", path("session"), "--quiet"}));

  station::write_json_file(path("hasty_rig.json"), hasty_rig(rig));
  std::filesystem::create_directory(path("hasty_calibration"));
  station::write_json_file(path("hasty_calibration/calibration.json"),
                           hasty_calibration(station::read_json_file(path("calibration/calibration.json"))));
}

void Workflow::TearDownTestSuite() {
  folder.reset();
}

std::string Workflow::path(const std::string& name) {
  return *folder / name;
}

std::vector<std::string> Workflow::capture_arguments(const std::string& session, const std::string& rig,
                                                     const std::string& spool, const std::string& calibration) {
  return {"capture",
          "--rig",
          path(rig),
          "--calibration",
          path(calibration),
          "--spool",
          std::string(DATA_DIR) + "/spools/" + spool + ".json",
          "--out",
          session,
          "--unattended",
          "--quiet"};
}

std::vector<std::string> Workflow::hasty_capture_arguments(const std::string& session) {
  return capture_arguments(session, "hasty_rig.json", "silk_red", "hasty_calibration");
}

ProgramResult Workflow::capture(const std::string& session) {
  return run_threadstation(capture_arguments(session));
}

}  // namespace station_test

// A test fixture with one calibrated simulated rig and one captured and developed session, for all tests that run the
// program's commands one after the other; few samples a pixel, so that drawing takes little time. Each suite has a copy
// of its own.
#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tests/station/commands/program.h"

namespace station_test {

void expect_success(const ProgramResult& result);
// Expects exit status 1 and one line on standard error that contains `must_name`.
void expect_one_line(const ProgramResult& result, const std::string& must_name);

// The rig's file, its calibration and the session, made in an empty folder. ctest makes them once for all suites, in
// the folder that this variable of the environment names; a suite that is run by hand makes its own.
void make_calibrated_bench(const std::filesystem::path& folder);
inline constexpr const char* kCalibratedBench = "THREADSTATION_CALIBRATED_BENCH";

class Workflow : public ::testing::Test {
 protected:
  static void SetUpTestSuite();
  static void TearDownTestSuite();

  static std::string path(const std::string& name);
  // The arguments of a capture; `rig` and `calibration` are names for path().
  static std::vector<std::string> capture_arguments(const std::string& session, const std::string& rig = "rig.json",
                                                    const std::string& spool = "silk_red",
                                                    const std::string& calibration = "calibration");
  // The same with a sensor so coarse that drawing takes hardly any time, for tests of the capture itself.
  static std::vector<std::string> hasty_capture_arguments(const std::string& session);
  static ProgramResult capture(const std::string& session);
};

}  // namespace station_test

// One calibrated simulated rig and one captured and developed session, for all tests that run the program's commands one
// after the other; few samples a pixel, so that drawing takes little time.
#pragma once

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tests/station/program.h"

namespace station_test {

void expect_success(const ProgramResult& result);
// One clear line on standard error and exit status 1.
void expect_one_line(const ProgramResult& result, const std::string& must_name);

class Workflow : public ::testing::Test {
 protected:
  static void SetUpTestSuite();
  static void TearDownTestSuite();

  static std::string path(const std::string& name);
  // `rig` and `calibration` in path().
  static std::vector<std::string> capture_arguments(const std::string& session, const std::string& rig = "rig.json",
                                                    const std::string& spool = "silk_red",
                                                    const std::string& calibration = "calibration");
  // On the same bench with a sensor so coarse that drawing hardly counts: for tests of the capture itself.
  static std::vector<std::string> hasty_capture_arguments(const std::string& session);
  static ProgramResult capture(const std::string& session);
};

}  // namespace station_test

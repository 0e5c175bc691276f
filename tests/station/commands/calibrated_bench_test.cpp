// What Workflow's suites begin with, made once for them.

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>

#include "tests/station/commands/workflow.h"

namespace station_test {
namespace {

namespace fs = std::filesystem;

TEST(CalibratedBench, IsMadeForTheSuitesThatBeginWithIt) {
  const char* folder = std::getenv(kCalibratedBench);
  if (folder == nullptr) FAIL() << "ctest -R CalibratedBench says where: " << kCalibratedBench << " is not set";
  fs::remove_all(folder);
  fs::create_directories(folder);
  make_calibrated_bench(folder);
}

}  // namespace
}  // namespace station_test

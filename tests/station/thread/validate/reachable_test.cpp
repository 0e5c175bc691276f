// A thread that no fit can find is refused before anything is drawn.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "station/documents/reader.h"
#include "station/thread/validate/recover_thread.h"
#include "tests/places.h"
#include "tests/support/message_of.h"
#include "tests/support/temporary_folder.h"

namespace station {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

struct ReachableThread : testing::Test {
  std::string refused(const std::string& key, const json& value) const {
    json thread = read_json_file(fs::path(DATA_DIR) / "threads/silk_blue.json");
    thread["parameters"][key] = value;
    write_json_file(folder / "thread.json", thread);
    return message_of([&] {
      recover_thread({.rig = fs::path(DATA_DIR) / "rigs/simulated.json",
                      .spool = fs::path(DATA_DIR) / "spools/silk_blue.json",
                      .thread = folder / "thread.json",
                      .draws = 0,
                      .progress_style = ProgressStyle::quiet});
    });
  }
  TemporaryFolder folder;
};

TEST_F(ReachableThread, HasNothingBeyondABound) {
  EXPECT_THAT(refused("sigma_a", {80, 0.2, 0.3}),
              testing::AllOf(testing::HasSubstr("sigma_a is 80"), testing::HasSubstr("most of a fit is 50")));
  EXPECT_THAT(refused("r0", {0.6, 0.0, 0.2}), testing::HasSubstr("lambda_0"));  // a trough, where energies are arches
}

}  // namespace
}  // namespace station

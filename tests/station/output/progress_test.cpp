#include "station/output/progress.h"

#include <gtest/gtest.h>

#include <chrono>
#include <nlohmann/json.hpp>

namespace station {
namespace {

nlohmann::json shown(ProgressDisplay& display, int done) {
  testing::internal::CaptureStderr();
  display.show(done, 17, "view");
  return nlohmann::json::parse(testing::internal::GetCapturedStderr());
}

TEST(Progress, TheTimeLeftIsGuessedFromWhatThisRunHasDone) {
  std::chrono::steady_clock::time_point now{};
  ProgressDisplay display("capture", ProgressStyle::json_lines, [&] { return now; });
  EXPECT_FALSE(shown(display, 11).contains("seconds_left"));  // eleven views of an earlier run took no time of this one
  now += std::chrono::seconds(3);
  EXPECT_EQ(shown(display, 12).at("seconds_left"), 5 * 3);
}

TEST(Progress, ATimeThatIsGivenIsShown) {
  ProgressDisplay display("capture", ProgressStyle::json_lines);
  testing::internal::CaptureStderr();
  display.show(0, 17, "view", 96);
  EXPECT_EQ(nlohmann::json::parse(testing::internal::GetCapturedStderr()).at("seconds_left"), 96);
}

}  // namespace
}  // namespace station

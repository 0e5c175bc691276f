#include "station/output/progress.h"

#include <gtest/gtest.h>

#include <chrono>
#include <nlohmann/json.hpp>
#include <thread>

namespace station {
namespace {

nlohmann::json shown(ProgressDisplay& display, int done) {
  testing::internal::CaptureStderr();
  display.show(done, 17, "view");
  return nlohmann::json::parse(testing::internal::GetCapturedStderr());
}

TEST(Progress, TheTimeLeftIsGuessedFromWhatThisRunHasDone) {
  ProgressDisplay display("capture", ProgressStyle::json);
  EXPECT_FALSE(shown(display, 11).contains("seconds_left"));  // eleven views of an earlier run took no time of this one
  const double elapsed_s = 0.05;
  std::this_thread::sleep_for(std::chrono::duration<double>(elapsed_s));
  EXPECT_GE(shown(display, 12).at("seconds_left").get<double>(), 5 * elapsed_s);
}

TEST(Progress, ATimeThatIsGivenIsShown) {
  ProgressDisplay display("capture", ProgressStyle::json);
  testing::internal::CaptureStderr();
  display.show(0, 17, "view", 96);
  EXPECT_EQ(nlohmann::json::parse(testing::internal::GetCapturedStderr()).at("seconds_left"), 96);
}

}  // namespace
}  // namespace station

// A session that was interrupted and went on, in a new process, against one that was not.
#include <gtest/gtest.h>

#include "calibration/sensor_file.h"
#include "tests/station/sessions/recorded_bench.h"

namespace station {
namespace {

std::map<std::string, cv::Mat1w> mosaics_of(const std::filesystem::path& session) {
  std::map<std::string, cv::Mat1w> mosaics;
  for (const auto& [step, picture] : pictures_of(session))
    mosaics[step] = calibration::read_sensor_file((session / picture.file).string()).mosaic;
  return mosaics;
}

// A lamp that fades with the clock lights a picture that is taken later less: here it does not fade.
struct SteadyBench : RecordedBench {
  SteadyBench() {
    asked.rig.simulation->truth.lamp_changes = {};
    build();
  }
};

bool same(const cv::Mat1w& a, const cv::Mat1w& b) {
  return a.size() == b.size() && cv::norm(a, b, cv::NORM_INF) == 0;
}

}  // namespace

TEST(ResumedSession, HasThePicturesThatItWouldHaveHad) {
  SteadyBench whole;
  int captures = 0;
  whole.on_capture = [&](rig::Camera& device) {
    ++captures;
    return device.capture();
  };
  ASSERT_EQ(whole.run(), "");
  const auto expected = mosaics_of(whole.path);
  ASSERT_EQ(expected.size(), whole.asked.plan.steps.size());
  for (const int last : {1, captures / 2, captures - 1}) {
    SteadyBench first, second;
    int taken = 0;
    first.on_capture = [&](rig::Camera& device) {
      if (++taken > last) throw std::runtime_error("the plug was pulled");
      return device.capture();
    };
    EXPECT_NE(first.run(), "");
    second.path = first.path;
    EXPECT_EQ(second.run(), "");
    for (const auto& [step, mosaic] : mosaics_of(first.path))
      EXPECT_TRUE(same(mosaic, expected.at(step))) << step << ", interrupted after " << last << " of " << captures;
  }
}

TEST(ResumedSession, TakesAViewAgainWithOtherNoiseAndLeavesTheOthers) {
  RecordedBench first, second;
  ASSERT_EQ(first.run(), "");
  const auto before = mosaics_of(first.path);
  second.path = first.path;
  ASSERT_EQ(second.run({.reshoot = {"1"}}), "");
  for (const auto& [step, mosaic] : mosaics_of(first.path))
    EXPECT_EQ(same(mosaic, before.at(step)), step != "reflection-horizontal-1") << step;
}

}  // namespace station

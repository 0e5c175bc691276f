// What a picture says of the lamp's side, by the light on the holder's tags.
#include "station/session/checks/lamp_checks.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numbers>

#include "station/bench/camera_adapter.h"
#include "station/bench/mounted_holder.h"
#include "station/documents/plan_file.h"
#include "tests/station/session/recorded_bench.h"

namespace station {
namespace {

// One evenly grey picture of the recorded session's bench: `part` of what the lamp in front gives a white surface.
std::optional<Finding> lamp_side(const std::string& step_id, double part, bool saturated) {
  SessionFile asked = read_session_file(recorded_session());
  asked.rig.reference_chip.reset();  // the tags alone
  const RigCalibration calibration = read_calibration(recorded_session() / "calibration");
  const PlanStep step = *find_step(asked.plan, step_id);
  const Eigen::Isometry3d world_from_holder = Eigen::AngleAxisd(step.platform_angle_rad, Eigen::Vector3d::UnitZ()) *
                                              nominal_holder_pose(asked.rig, asked.spool.wrapping, step.mounting);
  const renderer::Camera camera =
      camera_of(calibration.lens.lens, world_from_holder.inverse() * calibration.platform.world_from_camera, true);
  const inversion::NearLight front =
      lamp_in_holder(calibration, asked.rig, rig::Lamp::front, world_from_holder.inverse());
  const double white = front.intensity.mean() / front.position.squaredNorm() / std::numbers::pi;
  calibration::Developed developed;
  developed.radiance = cv::Mat3f(camera.height, camera.width, cv::Vec3f::all(static_cast<float>(part * white)));
  developed.saturated = cv::Mat1b(camera.height, camera.width, static_cast<uchar>(saturated ? 255 : 0));
  const DevelopPart develop = [&](const cv::Rect& box) -> calibration::Developed {
    return {.radiance = developed.radiance(box), .variance = {}, .saturated = developed.saturated(box)};
  };
  for (const Finding& finding :
       LampChecks(asked, calibration).judge(step, develop, camera, world_from_holder.inverse()))
    if (finding.check == "lamp_side") return finding;
  return std::nullopt;
}

TEST(LampSide, DarkTagsAreLitFromBehind) {
  const auto reflection = lamp_side("reflection-horizontal-1", 0.005, false);
  ASSERT_TRUE(reflection);
  EXPECT_EQ(reflection->grade, Grade::bad);
  EXPECT_THAT(reflection->reason, testing::HasSubstr("holder's front is dark; put the lamp in front of"));
  const auto transmission = lamp_side("transmission-1", 0.005, false);
  ASSERT_TRUE(transmission);
  EXPECT_EQ(transmission->grade, Grade::good) << transmission->reason;
}

TEST(LampSide, BrightTagsAreLitFromTheFront) {
  const auto reflection = lamp_side("reflection-horizontal-1", 0.5, false);
  ASSERT_TRUE(reflection);
  EXPECT_EQ(reflection->grade, Grade::good) << reflection->reason;
  const auto transmission = lamp_side("transmission-1", 0.5, true);  // at least half, which is enough
  ASSERT_TRUE(transmission);
  EXPECT_EQ(transmission->grade, Grade::bad);
  EXPECT_THAT(transmission->reason, testing::HasSubstr("put the lamp behind"));
}

// A long exposure of dark threads burns the paper out: what was read is a lower bound.
TEST(LampSide, SaturatedTagsBelowTheLimitSayNothing) {
  EXPECT_FALSE(lamp_side("reflection-horizontal-1", 0.005, true));
  EXPECT_FALSE(lamp_side("transmission-1", 0.005, true));
}

}  // namespace
}  // namespace station

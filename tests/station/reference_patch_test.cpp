#include "station/reference_patch.h"

#include <gtest/gtest.h>

#include <cmath>

namespace station {
namespace {

const inversion::WrappedSpool kSpool;
const ReferencePatch kPatch;

PatchView seen(double strength, double time_s, bool behind = false) {
  return {.behind = behind, .time_s = time_s, .reading = PatchReading{.strength = strength, .sigma = 0}};
}

// A camera at 600 mm in front of the holder and half as much above, and a lamp beside it.
renderer::Camera camera_above() {
  renderer::Camera camera{.width = 600, .height = 400, .fx = 2400, .fy = 2400, .cx = 300, .cy = 200};
  const Eigen::Vector3d position(600, 0, 300), forward = -position.normalized();
  camera.world_from_camera.translation() = position;
  camera.world_from_camera.linear().col(0) = forward.cross(Eigen::Vector3d::UnitZ()).normalized();
  camera.world_from_camera.linear().col(1) = forward.cross(camera.world_from_camera.linear().col(0));
  camera.world_from_camera.linear().col(2) = forward;
  return camera;
}

const inversion::NearLight kLamp{.position = {330, 110, 380}, .intensity = {2e6, 3e6, 2e6}, .radius_mm = 4};

double expected_sum() {
  const Eigen::Isometry3d chip = holder_from_patch(kPatch, kSpool, rig::Mounting::horizontal);
  const Eigen::Vector3d to_light = kLamp.position - chip.translation();
  return 0.4 / M_PI * 7e6 * to_light.normalized().z() / to_light.squaredNorm();
}

TEST(ReferencePatch, TheChipOfEachMountingLiesUpAndBehindTheFrontFace) {
  const Eigen::Isometry3d horizontal = holder_from_patch(kPatch, kSpool, rig::Mounting::horizontal);
  const Eigen::Isometry3d vertical = holder_from_patch(kPatch, kSpool, rig::Mounting::vertical);
  const Eigen::Matrix3d turned = Eigen::AngleAxisd(M_PI / 2, Eigen::Vector3d::UnitX()).toRotationMatrix();
  EXPECT_TRUE(horizontal.linear().col(2).isApprox(Eigen::Vector3d::UnitZ(), 1e-12));
  EXPECT_TRUE((turned * vertical.linear().col(2)).isApprox(Eigen::Vector3d::UnitZ(), 1e-12));
  for (const Eigen::Isometry3d& pose : {horizontal, vertical})
    for (const double x : {-4.0, 4.0}) EXPECT_LT((pose * Eigen::Vector3d(x, 0, 0)).x(), 1e-12);
}

TEST(ReferencePatch, ALambertianChipUnderTheCalibratedLampReadsOne) {
  const double grey = expected_sum() / 3;
  const cv::Mat3f picture(400, 600, cv::Vec3f::all(static_cast<float>(0.97 * grey)));
  const auto reading = read_patch(picture, cv::Mat1b(400, 600, uchar{0}), camera_above(), kPatch, kSpool,
                                  rig::Mounting::horizontal, kLamp);
  ASSERT_TRUE(reading);
  EXPECT_NEAR(reading->strength, 0.97, 1e-5);  // single precision
}

TEST(ReferencePatch, ASaturatedAnUnseenOrAnUnlitChipGivesNoReading) {
  const cv::Mat3f picture(400, 600, cv::Vec3f::all(1));
  const cv::Mat1b clear(400, 600, uchar{0}), saturated(400, 600, uchar{255});
  const auto read = [&](const cv::Mat1b& flags, const renderer::Camera& camera, rig::Mounting mounting,
                        const inversion::NearLight& light) {
    return read_patch(picture, flags, camera, kPatch, kSpool, mounting, light).has_value();
  };
  EXPECT_TRUE(read(clear, camera_above(), rig::Mounting::horizontal, kLamp));
  EXPECT_FALSE(read(saturated, camera_above(), rig::Mounting::horizontal, kLamp));
  renderer::Camera aside = camera_above();
  aside.cx = 5000;
  EXPECT_FALSE(read(clear, aside, rig::Mounting::horizontal, kLamp));
  inversion::NearLight below = kLamp;
  below.position.z() = -300;
  EXPECT_FALSE(read(clear, camera_above(), rig::Mounting::horizontal, below));
}

TEST(ReferencePatch, StrengthsAreRelativeToTheFirstViewWhateverTheChipsOwnFactors) {
  // Readings have a factor of 1.03 in front and 0.9 behind.
  const std::vector<double> strengths = lamp_strengths({seen(1.03, 100),
                                                        seen(1.03 * 0.99, 110),
                                                        seen(1.03 * 0.98, 120),
                                                        seen(0.9 * 0.975, 130, true),
                                                        seen(0.9 * 0.965, 150, true),
                                                        {.behind = true, .time_s = 160, .reading = {}},
                                                        seen(1.03 * 0.94, 200)});
  const std::vector<double> truth{1, 0.99, 0.98, 0.975, 0.965, 0.965, 0.94};
  ASSERT_EQ(strengths.size(), truth.size());
  for (std::size_t i = 0; i < truth.size(); ++i) EXPECT_NEAR(strengths[i], truth[i], 1e-12) << i;
  EXPECT_EQ(lamp_strengths({{}, {}}), (std::vector<double>{1, 1}));
}

}  // namespace
}  // namespace station

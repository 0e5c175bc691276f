#include "station/bench/reference_chip.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <numbers>

#include "calibration/light/spectralon.h"
#include "station/bench/bench_picture.h"
#include "station/bench/camera_adapter.h"
#include "station/bench/mounted_holder.h"
#include "station/documents/rig_file.h"
#include "station/documents/spool.h"
#include "tests/places.h"

namespace station {
namespace {

const inversion::WrappedSpool kSpool;
const ReferenceChip kChip;

ChipView seen(double strength, double time_s, bool behind = false) {
  return {.behind = behind, .time_s = time_s, .reading = ChipReading{.strength = strength, .sigma = 0}};
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

double expected_sum(const inversion::NearLight& lamp = kLamp) {
  const Eigen::Isometry3d chip = holder_from_chip(kChip, kSpool, rig::Mounting::horizontal);
  const Eigen::Vector3d to_light = lamp.position - chip.translation();
  return 0.4 / std::numbers::pi * 7e6 * to_light.normalized().z() / to_light.squaredNorm();
}

TEST(ReferenceChip, TheChipOfEachMountingLiesUpAndBehindTheFrontFace) {
  const Eigen::Isometry3d horizontal = holder_from_chip(kChip, kSpool, rig::Mounting::horizontal);
  const Eigen::Isometry3d vertical = holder_from_chip(kChip, kSpool, rig::Mounting::vertical);
  const Eigen::Matrix3d turned = Eigen::AngleAxisd(std::numbers::pi / 2, Eigen::Vector3d::UnitX()).toRotationMatrix();
  EXPECT_TRUE(horizontal.linear().col(2).isApprox(Eigen::Vector3d::UnitZ(), 1e-12));
  EXPECT_TRUE((turned * vertical.linear().col(2)).isApprox(Eigen::Vector3d::UnitZ(), 1e-12));
  for (const Eigen::Isometry3d& pose : {horizontal, vertical})
    for (const double x : {-4.0, 4.0}) EXPECT_LT((pose * Eigen::Vector3d(x, 0, 0)).x(), 1e-12);
}

TEST(ReferenceChip, ALambertianChipUnderTheCalibratedLampReadsOne) {
  const double grey = expected_sum() / 3;
  const cv::Mat3f picture(400, 600, cv::Vec3f::all(static_cast<float>(0.97 * grey)));
  const auto reading = read_chip(picture, cv::Mat1b(400, 600, uchar{0}), camera_above(), kChip, kSpool,
                                 rig::Mounting::horizontal, kLamp, {0, 0});
  ASSERT_TRUE(reading);
  EXPECT_NEAR(reading->strength, 0.97, 1e-5);  // single precision
}

// In front and behind the chip is lit at about 50 degrees and seen at 63: towards the lamp, away from it.
TEST(ReferenceChip, AChipThatDroopsAsThePanelReadsOne) {
  constexpr double kDroop = 0.14;
  for (const double side : {1.0, -1.0}) {
    inversion::NearLight lamp = kLamp;
    lamp.position.x() *= side;
    const Eigen::Isometry3d chip = holder_from_chip(kChip, kSpool, rig::Mounting::horizontal);
    const Eigen::Vector3d to_light = (lamp.position - chip.translation()).normalized(),
                          to_camera =
                              (camera_above().world_from_camera.translation() - chip.translation()).normalized();
    const double cos_phi =
        to_light.head<2>().normalized().dot(to_camera.head<2>().normalized());  // the normal is upright
    const double factor = 1 + kDroop * calibration::droop_shape(to_light.z(), to_camera.z(), cos_phi);
    EXPECT_GT(side * (1 - factor), 0.05);  // what is left out when the chip is taken for Lambertian
    const double grey = factor * expected_sum(lamp) / 3;
    const cv::Mat3f picture(400, 600, cv::Vec3f::all(static_cast<float>(grey)));
    const auto reading = read_chip(picture, cv::Mat1b(400, 600, uchar{0}), camera_above(), kChip, kSpool,
                                   rig::Mounting::horizontal, lamp, {kDroop, 0});
    ASSERT_TRUE(reading);
    EXPECT_NEAR(reading->strength, 1, 1e-5);  // single precision
  }
}

// The bench draws the chip as it draws the panel.
TEST(ReferenceChip, OnTheBenchAChipOfADroopingPanelsKindReadsTheCalibratedLamp) {
  RigFile rig = read_rig(std::string(DATA_DIR) + "/rigs/simulated.json");
  const Spool spool = read_spool(std::string(DATA_DIR) + "/spools/silk_red.json");
  SimulatedRig& simulation = *rig.simulation;
  simulation.spectralon_droop = 0.14;
  simulation.samples_per_pixel = 1;
  simulation.target_samples_per_pixel = 8;
  const rig::DrawPicture draw = make_bench_picture(rig, spool);
  const Eigen::Isometry3d world_from_holder = nominal_holder_pose(rig, spool.wrapping, rig::Mounting::horizontal);
  for (const rig::TrueLamp& lamp : {simulation.truth.front, simulation.truth.back}) {
    rig::BenchState state{.lens = simulation.truth.lens, .world_from_object = world_from_holder, .lamp = lamp};
    state.arrangement.object = rig::BenchObject::holder;
    const cv::Mat3f picture = draw(state);
    const Eigen::Isometry3d holder_from_world = world_from_holder.inverse();
    const inversion::NearLight light{.position = holder_from_world * lamp.position,
                                     .intensity = lamp.intensity,
                                     .radius_mm = lamp.radius_mm,
                                     .beam_axis = holder_from_world.linear() * (lamp.aim - lamp.position).normalized(),
                                     .beam_exponent = lamp.beam_exponent};
    const auto read = [&](double droop) {
      return read_chip(picture, cv::Mat1b(picture.size(), uchar{0}),
                       camera_of(lens_of(state.lens), holder_from_world * state.lens.world_from_camera, false),
                       *rig.reference_chip, spool.wrapping, rig::Mounting::horizontal, light, {droop, 0});
    };
    ASSERT_TRUE(read(0));
    std::printf("lamp %s: the chip reads %.4f, taken for Lambertian %.4f\n",
                lamp.position.x() > 0 ? "in front" : "behind", read(0.14)->strength, read(0)->strength);
    EXPECT_NEAR(read(0.14)->strength, 1, 0.03);  // threads and frame send a little more light
    EXPECT_GT(std::abs(read(0)->strength - 1), 0.05);
  }
}

TEST(ReferenceChip, ASaturatedAnUnseenOrAnUnlitChipGivesNoReading) {
  const cv::Mat3f picture(400, 600, cv::Vec3f::all(1));
  const cv::Mat1b clear(400, 600, uchar{0}), saturated(400, 600, uchar{255});
  const auto read = [&](const cv::Mat1b& flags, const renderer::Camera& camera, rig::Mounting mounting,
                        const inversion::NearLight& light) {
    return read_chip(picture, flags, camera, kChip, kSpool, mounting, light, {0, 0}).has_value();
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

TEST(ReferenceChip, StrengthsAreRelativeToTheFirstViewWhateverTheChipsOwnFactors) {
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

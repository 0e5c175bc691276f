#include "rig/simulated/sensor_defects.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tests/rig/simulated/raw_reader.h"
#include "tests/rig/simulated/uniform_bench.h"

namespace {

const cv::Size kSize(600, 400);

double fraction(const cv::Mat& selected) {
  return cv::countNonZero(selected) / static_cast<double>(kSize.area());
}

}  // namespace

TEST(SensorDefects, NoneMeansAPerfectSensor) {
  const rig::DefectMaps maps = rig::defect_maps({}, {60, 40}, 3);
  EXPECT_EQ(cv::countNonZero(maps.sensitivity != 1), 0);
  EXPECT_EQ(cv::countNonZero(maps.offset_dn), 0);
  EXPECT_EQ(cv::countNonZero(maps.dark_current_e_s), 0);
  EXPECT_EQ(cv::countNonZero(maps.read_noise_factor != 1), 0);
  EXPECT_EQ(rig::shutter_factor({}, 0.25, 3), 1.0);
}

TEST(SensorDefects, AsManyPixelsAreBadAsWereAskedAndTheSameForTheSameSeed) {
  const rig::SensorDefects defects{
      .hot_fraction = 0.01, .hot_dark_current_e_s = 100, .dead_fraction = 0.02, .noisy_fraction = 0.005};
  const rig::DefectMaps maps = rig::defect_maps(defects, kSize, 3);
  // Five standard errors of a count of 240000 * 0.02 pixels.
  EXPECT_NEAR(fraction(maps.dark_current_e_s >= 50), 0.01, 1.5e-3);
  EXPECT_NEAR(fraction(maps.sensitivity <= 0.2), 0.02, 1.5e-3);
  EXPECT_NEAR(fraction(maps.read_noise_factor == 10), 0.005, 1.5e-3);
  EXPECT_EQ(cv::countNonZero(maps.sensitivity != rig::defect_maps(defects, kSize, 3).sensitivity), 0);
  EXPECT_NE(cv::countNonZero(maps.sensitivity != rig::defect_maps(defects, kSize, 4).sensitivity), 0);
}

TEST(SensorDefects, DustIsASmoothDarkSpotOfTheAskedDepth) {
  const rig::DefectMaps maps = rig::defect_maps({.dust_spots = 1, .dust_depth = 0.1, .dust_radius_px = 15}, kSize, 3);
  double least = 0, most = 0;
  cv::minMaxLoc(maps.sensitivity, &least, &most);
  EXPECT_NEAR(least, 0.9, 1e-3);  // the spot's middle lies within half a pixel of a pixel's
  EXPECT_EQ(most, 1);
  const cv::Mat1f step(cv::abs(maps.sensitivity.colRange(1, 600) - maps.sensitivity.colRange(0, 599)));
  cv::minMaxLoc(step, &least, &most);
  EXPECT_LT(most, 0.1 / 15);  // steepest slope of a Gaussian: 0.86 depth / radius
}

TEST(SensorDefects, ThePatternsHaveTheirSpread) {
  const rig::DefectMaps maps = rig::defect_maps({.sensitivity_spread = 0.01, .offset_spread_dn = 2}, kSize, 3);
  cv::Scalar mean, deviation;
  cv::meanStdDev(maps.sensitivity, mean, deviation);
  EXPECT_NEAR(deviation[0] / 0.01, 1, 0.01);  // standard error over 240000 pixels: 0.0014
  cv::meanStdDev(maps.offset_dn, mean, deviation);
  EXPECT_NEAR(deviation[0] / 2, 1, 0.01);
}

TEST(SensorDefects, EachShutterTimeHasItsOwnErrorOfTheSpread) {
  double squares = 0;
  for (int i = 0; i < 400; ++i)
    squares += std::pow(std::log(rig::shutter_factor({.shutter_spread = 0.01}, 0.01 + i * 1e-3, 3)), 2);
  EXPECT_NEAR(std::sqrt(squares / 400) / 0.01, 1, 0.18);  // five standard errors 1 / sqrt(800)
  EXPECT_NE(rig::shutter_factor({.shutter_spread = 0.01}, 0.5, 3),
            rig::shutter_factor({.shutter_spread = 0.01}, 0.25, 3));
}

TEST(SensorDefects, TheCameraBendsAndMistimesAsItsTruthSays) {
  rig::BenchTruth truth{
      .sensor = {.read_noise_e = 0, .dark_current_e_s = 0, .defects = {.nonlinearity = 0.05, .shutter_spread = 0.01}}};
  UniformBench bench({0.5F, 0.5F, 0.5F}, truth);
  for (const double exposure_s : {0.25, 1.0}) {
    bench.camera->configure({.exposure_s = exposure_s});
    const double level = (cv::mean(read_raw(bench.camera->capture().bytes).mosaic)[0] - 512) / 15871;
    const double light = 0.5 * exposure_s * rig::shutter_factor(truth.sensor.defects, exposure_s, truth.seed);
    EXPECT_NEAR(level, light * (1 - 0.05 * light), 5e-5) << exposure_s;  // five standard errors and the rounding
  }
}

TEST(SensorDefects, BlurKeepsTheLightAndWidensAPoint) {
  rig::BenchTruth truth{.lens = {.blur_px = 2.0}};
  rig::SimulatedBench bench(truth, [](const rig::BenchState& state) {
    cv::Mat3f drawn(state.lens.height_px, state.lens.width_px, cv::Vec3f());
    drawn(200, 300) = cv::Vec3f(30, 30, 30);
    return drawn;
  });
  rig::SimulatedClock clock(1.8e9);
  const auto camera = rig::make_simulated_camera(bench, clock);
  camera->configure({.exposure_s = 0.5});
  const cv::Mat1w mosaic = read_raw(camera->capture().bytes).mosaic;
  const double middle = mosaic(200, 300) - 512.0, beside = mosaic(200, 302) - 512.0;
  EXPECT_NEAR(middle / 15871, 15 / (2 * std::numbers::pi * 4),
              0.02);  // the kernel's pixels are sums over a finite window
  EXPECT_NEAR(beside / middle, std::exp(-0.5), 0.02);
}

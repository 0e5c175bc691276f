#include "calibration/sensor/sensor_maps.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <opencv2/imgproc.hpp>

#include "tests/calibration/sensor/simulated_sensor.h"

namespace calibration {
namespace {

TEST(SensorMaps, NearlyAllBadPixelsAreFoundAndHardlyAnyGoodOne) {
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    simulated_sensor::Camera camera(simulated_sensor::defective_sensor(), seed);
    const simulated_sensor::Calibrated found = simulated_sensor::calibrate(camera);
    const rig::DefectMaps truth = rig::defect_maps(camera.truth().sensor.defects, {600, 400}, seed);
    const cv::Mat1b hot(truth.dark_current_e_s > 0), noisy(truth.read_noise_factor > 1), dead(truth.sensitivity < 0.5);
    const cv::Mat1b all(hot | noisy | dead);
    const auto part = [](const cv::Mat1b& these, const cv::Mat1b& of) {
      return cv::countNonZero(these & of) / static_cast<double>(cv::countNonZero(of));
    };
    const cv::Mat1b& bad = found.darks.maps.bad;
    std::printf("seed %llu: hot %d, noisy %d, dead %d; found %.2f %% of the bad, %d good ones called bad\n",
                static_cast<unsigned long long>(seed), found.darks.bad.hot, found.darks.bad.noisy, found.flats.dead,
                100 * part(bad, all), cv::countNonZero(bad & ~all));
    EXPECT_EQ(part(bad, hot), 1);
    EXPECT_EQ(part(bad, dead), 1);
    EXPECT_GT(part(bad, noisy), 0.98);  // 16 values of ten times the noise stay below three times it by rare chance
    EXPECT_LT(cv::countNonZero(bad & ~all), 24);  // 1e-4 of the pixels: 5 sigma in noise that only is normal
  }
}

TEST(SensorMaps, BiasAndDarkCurrentComeBackPixelByPixel) {
  simulated_sensor::Camera camera(
      {.dark_current_e_s = 20, .defects = {.hot_fraction = 0.01, .hot_dark_current_e_s = 300, .offset_spread_dn = 1.5}},
      5);
  const rig::DefectMaps truth = rig::defect_maps(camera.truth().sensor.defects, {600, 400}, 5);
  const DarkFit found = simulated_sensor::calibrate(camera).darks;
  const double gain = 15871 / 50000.0;
  EXPECT_NEAR(found.bias_dn, 512, 0.02);
  EXPECT_NEAR(found.dark_dn_per_s, 20 * gain, 0.05 * 20 * gain);
  double squares = 0, rates = 0;
  int hot = 0;
  for (int row = 0; row < 400; ++row)
    for (int column = 0; column < 600; ++column) {
      squares += std::pow(found.maps.bias_dn(row, column) - 512 - truth.offset_dn(row, column), 2);
      if (truth.dark_current_e_s(row, column) < 150) continue;
      const double rate = gain * (20 + truth.dark_current_e_s(row, column));
      rates += found.maps.dark_dn_per_s(row, column) / rate - 1;
      ++hot;
    }
  const double noise = std::sqrt(25 * gain * gain + 1 / 12.0) / 4;  // of the mean of 16 frames
  EXPECT_NEAR(std::sqrt(squares / 240000) / noise, 1, 0.1);         // a few electrons of dark current beside it
  EXPECT_GT(hot, 2000);
  EXPECT_NEAR(rates / hot, 0, 0.005);
}

TEST(SensorMaps, DustIsFoundToAHalfPercentAndACleanSensorStaysFlat) {
  for (const int spots : {0, 8}) {
    rig::TrueSensor sensor = simulated_sensor::defective_sensor();
    sensor.defects.dust_spots = spots;
    sensor.defects.dust_depth = 0.06;
    simulated_sensor::Camera camera(sensor, 9);
    const simulated_sensor::Calibrated found = simulated_sensor::calibrate(camera);
    rig::SensorDefects dust_alone{.dust_spots = spots, .dust_depth = 0.06, .dust_radius_px = 12};
    const cv::Mat1f dust = rig::defect_maps(dust_alone, {600, 400}, 9).sensitivity;
    cv::Scalar mean, deviation;
    cv::meanStdDev(found.darks.maps.flat / dust, mean, deviation);
    std::printf("%d spots: flat / truth = %.4f +- %.4f (predicted noise %.4f), deepest %.4f\n", spots, mean[0],
                deviation[0], found.flats.flat_noise, found.flats.deepest);
    EXPECT_NEAR(mean[0], 1, 0.002);
    // The pixels' own pattern of 0.5 % is smoothed to 0.05 %; the surface of 4th order gives way to a spot a little.
    EXPECT_LT(deviation[0], 0.002);
    EXPECT_NEAR(found.flats.deepest, spots > 0 ? 0.06 : 0, 0.012);  // two spots may overlap
  }
}

TEST(SensorMaps, DarksAndFlatsThatDoNotServeAreRefused) {
  simulated_sensor::Camera camera({}, 2, {}, {60, 40});
  PictureStack few, brief, lasting;
  for (int i = 0; i < 8; ++i) brief.add(camera.photograph(0.01)), lasting.add(camera.photograph(0.02));
  few.add(camera.photograph(1));
  EXPECT_THROW(fit_dark_maps(brief, few), std::runtime_error);      // one frame
  EXPECT_THROW(fit_dark_maps(brief, lasting), std::runtime_error);  // a factor of two
  EXPECT_THROW(brief.add(camera.photograph(0.5)), std::runtime_error);
  PictureStack longer;
  for (int i = 0; i < 8; ++i) longer.add(camera.photograph(0.5));
  SensorMaps maps = fit_dark_maps(brief, longer).maps;
  EXPECT_THROW(fit_flat_maps({}, 16383, maps), std::runtime_error);
  camera.look_at([](double, double) { return 100; });
  PictureStack saturated;
  saturated.add(camera.photograph(0.5));
  EXPECT_THROW(fit_flat_maps({saturated}, 16383, maps), std::runtime_error);
}

}  // namespace
}  // namespace calibration

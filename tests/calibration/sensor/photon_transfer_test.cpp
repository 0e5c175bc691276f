// Figures of the sensor's calibration by Monte Carlo: simulated sensors with bad pixels, dust, a fixed pattern, a bent
// response and shutter errors, each seed another sensor.
#include "calibration/sensor/photon_transfer.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>

#include "calibration/develop/merge_exposures.h"
#include "tests/calibration/sensor/simulated_sensor.h"

namespace calibration {
namespace {

constexpr double kGain = 15871 / 50000.0;  // DN per electron of the simulated sensor at ISO 100

double log_shutter_error(const rig::BenchTruth& truth, const ShutterTime& time, double reference_s) {
  const double true_ratio = rig::shutter_factor(truth.sensor.defects, time.nominal_s, truth.seed) /
                            rig::shutter_factor(truth.sensor.defects, reference_s, truth.seed);
  return std::log(time.true_s / time.nominal_s / true_ratio);
}

TEST(PhotonTransfer, GainReadNoiseLinearityAndShutterTimesComeBackWithBadPixelsDustAndShutterErrors) {
  double worst_gain = 0, worst_read = 0, worst_line = 0, worst_shutter = 0, gain_chi2 = 0, shutter_chi2 = 0;
  int times = 0;
  constexpr int kSeeds = 6;
  for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
    simulated_sensor::Camera camera(simulated_sensor::defective_sensor(), seed);
    const PhotonTransfer found = simulated_sensor::calibrate(camera).transfer;
    const SensorResponse& response = found.response;
    const double gain_error = response.gain_dn_per_e / kGain - 1;
    const double read_error = response.read_noise_e / 5 - 1;
    // The true response against the line through small signals, where the curve was measured.
    double line_error = 0;
    for (const LinearityPoint& point : found.linearity)
      line_error = std::max(line_error, std::abs(point.deviation + 0.004 * point.level));
    double shutter_error = 0;
    for (const ShutterTime& time : response.shutter) {
      const double error = log_shutter_error(camera.truth(), time, 1 / 6.0);
      shutter_error = std::max(shutter_error, std::abs(error));
      if (time.sigma_s > 0) shutter_chi2 += std::pow(error / (time.sigma_s / time.true_s), 2), ++times;
    }
    std::printf(
        "seed %llu: gain %.5f DN/e (%+.3f %% +- %.3f), read noise %.3f e (%+.2f %%), bend %.5f +- %.5f (true 0.004), "
        "linearity within %.4f %%, shutter within %.4f %%, scatter %.2f\n",
        static_cast<unsigned long long>(seed), response.gain_dn_per_e, 100 * gain_error,
        100 * response.gain_sigma / kGain, response.read_noise_e, 100 * read_error, response.nonlinearity,
        response.nonlinearity_sigma, 100 * line_error, 100 * shutter_error, found.scatter);
    worst_gain = std::max(worst_gain, std::abs(gain_error));
    worst_read = std::max(worst_read, std::abs(read_error));
    worst_line = std::max(worst_line, line_error);
    worst_shutter = std::max(worst_shutter, shutter_error);
    gain_chi2 += std::pow(gain_error * kGain / response.gain_sigma, 2);
    EXPECT_EQ(found.levels, 12);
  }
  std::printf("worst: gain %.3f %%, read noise %.2f %%, linearity %.4f %%, shutter %.4f %%\n", 100 * worst_gain,
              100 * worst_read, 100 * worst_line, 100 * worst_shutter);
  std::printf("error against prediction, rms: gain %.2f, shutter %.2f\n", std::sqrt(gain_chi2 / kSeeds),
              std::sqrt(shutter_chi2 / times));
  EXPECT_LT(worst_gain, 0.01);
  EXPECT_LT(worst_read, 0.02);  // the dark frames' 3.6 million values say 0.05 %; the rounding is known to 1 %
  EXPECT_LT(worst_line, 0.002);
  EXPECT_LT(worst_shutter, 0.002);
  // Six numbers scatter about their prediction by a factor of 0.45 to 1.6 at 1 %; errors of one ladder go together.
  EXPECT_GT(std::sqrt(gain_chi2 / kSeeds), 0.4);
  EXPECT_LT(std::sqrt(gain_chi2 / kSeeds), 1.7);
  EXPECT_GT(std::sqrt(shutter_chi2 / times), 0.4);
  EXPECT_LT(std::sqrt(shutter_chi2 / times), 1.7);
}

// The design's own figure: radiance over eight stops, from brackets a factor of four apart.
TEST(PhotonTransfer, MergedRadianceIsTrueToHalfAPercentOverEightStops) {
  double worst = 0;
  double chi2 = 0, pixels = 0;
  for (std::uint64_t seed = 11; seed <= 13; ++seed) {
    simulated_sensor::Camera camera(simulated_sensor::defective_sensor(), seed);
    const SensorResponse response = simulated_sensor::calibrate(camera).transfer.response;
    // 0 stops is 0.9 of full scale in the shortest exposure, 1/25 s; nine squares, each a stop darker than the one
    // before.
    const auto square_of = [](double column, double row) {
      return static_cast<int>(row / 134) * 3 + static_cast<int>(column / 200);
    };
    const auto radiance_of = [&](int square) { return 0.9 * 25 * std::exp2(-square); };
    camera.look_at([&](double column, double row) { return radiance_of(square_of(column, row)); });
    const double ratio = rig::shutter_factor(camera.truth().sensor.defects, 1 / 6.0, camera.truth().seed);
    const std::vector<SensorPicture> bracket{camera.photograph(1 / 25.), camera.photograph(1 / 6.),
                                             camera.photograph(0.6)};
    const LinearMosaic merged = merge_exposures(bracket, response);
    std::printf("seed %llu, error of the merged radiance by stops:", static_cast<unsigned long long>(seed));
    for (int square = 0; square < 9; ++square) {
      double sum = 0, variance = 0;
      int count = 0;
      const double truth = radiance_of(square) * ratio;
      for (int row = 0; row < 400; ++row)
        for (int column = 0; column < 600; ++column) {
          // Away from the edges, and from each pixel's own sensitivity (the fixed pattern is no part of the variance).
          if (square_of(column - 4, row - 4) != square || square_of(column + 4, row + 4) != square) continue;
          sum += merged.radiance(row, column);
          variance += merged.variance(row, column);
          ++count;
        }
      const double error = sum / count / truth - 1;
      worst = std::max(worst, std::abs(error));
      std::printf(" %d: %+.3f %%", -square, 100 * error);
      double spread = 0;
      for (int row = 0; row < 400; ++row)
        for (int column = 0; column < 600; ++column) {
          if (square_of(column - 4, row - 4) != square || square_of(column + 4, row + 4) != square) continue;
          if (!response.maps.bad(row, column)) spread += std::pow(merged.radiance(row, column) - sum / count, 2);
        }
      const double pattern = std::pow(0.005 * truth, 2) * count;
      chi2 += (spread - pattern) / (variance / count);
      pixels += count;
    }
    std::printf("\n");
  }
  std::printf("worst %.3f %%; spread against the variance plane: %.3f\n", 100 * worst, chi2 / pixels);
  EXPECT_LT(worst, 0.005);
  // The pattern's own spread varies by 1.4 % over 240000 pixels' worth of it in each sensor, and is the larger part.
  EXPECT_NEAR(chi2 / pixels, 1, 0.05);
}

TEST(PhotonTransfer, ALampThatDriftsMovesNeitherTheGainNorTheTimes) {
  simulated_sensor::Camera steady(simulated_sensor::defective_sensor(), 21);
  simulated_sensor::Camera drifting(simulated_sensor::defective_sensor(), 21, {.drift_per_s = -2e-4});
  const PhotonTransfer a = simulated_sensor::calibrate(steady).transfer;
  const PhotonTransfer b = simulated_sensor::calibrate(drifting).transfer;
  EXPECT_NEAR(b.response.gain_dn_per_e / a.response.gain_dn_per_e, 1, 0.01);
  for (std::size_t i = 0; i < a.response.shutter.size(); ++i)
    EXPECT_NEAR(b.response.shutter[i].true_s / a.response.shutter[i].true_s, 1, 1e-3) << i;  // up and down: it cancels
}

TEST(PhotonTransfer, TooFewExposuresOrNoContrastAreRefused) {
  simulated_sensor::Camera camera({}, 3);
  const simulated_sensor::Calibrated known = simulated_sensor::calibrate(camera);
  std::vector<PairLevels> few(known.ladder.begin(), known.ladder.begin() + 7);
  EXPECT_THROW(fit_photon_transfer(few, known.darks, 15871, known.ladder[4].nominal_s), std::runtime_error);
  EXPECT_THROW(fit_photon_transfer(known.ladder, known.darks, 15871, 30), std::runtime_error);
  camera.look_at({});
  EXPECT_THROW(make_level_bins(camera.photograph(0.25), known.darks.maps), std::runtime_error);
  EXPECT_THROW(measure_pair(camera.photograph(0.25), camera.photograph(0.5), {}, known.darks.maps), std::runtime_error);
}

}  // namespace
}  // namespace calibration

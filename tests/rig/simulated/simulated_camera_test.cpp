#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "tests/rig/simulated/raw_reader.h"
#include "tests/rig/simulated/uniform_bench.h"

namespace {

constexpr double kGain = (16383 - 512) / 50000.0;  // DN per electron at ISO 100
constexpr double kPixels = 600 * 400;

cv::Mat1d exposed(rig::Camera& camera, const rig::CameraSettings& settings) {
  camera.configure(settings);
  cv::Mat1d picture;
  read_raw(camera.capture().bytes).mosaic.convertTo(picture, CV_64F);
  return picture;
}

double mean(const cv::Mat1d& picture) {
  return cv::mean(picture)[0];
}

double standard_deviation(const cv::Mat1d& picture) {
  cv::Scalar average, deviation;
  cv::meanStdDev(picture, average, deviation);
  return deviation[0];
}

// Variance of one picture from the difference of two: what both have in common drops out.
double variance(const cv::Mat1d& a, const cv::Mat1d& b) {
  return std::pow(standard_deviation(cv::Mat1d(a - b)), 2) / 2;
}

}  // namespace

TEST(SimulatedCamera, TwiceTheExposureGivesTwiceTheSignal) {
  UniformBench rig({0.4F, 0.4F, 0.4F});
  const double once = mean(exposed(*rig.camera, {.exposure_s = 0.25})) - 512;
  const double twice = mean(exposed(*rig.camera, {.exposure_s = 0.5})) - 512;
  EXPECT_NEAR(once, 0.4 * 0.25 * 15871 + 2 * 0.25 * kGain, 0.25);  // 5 standard errors: 5 sqrt(5000 e) kGain / 490
  EXPECT_NEAR(twice / once, 2, 4e-4);  // 5 standard errors; the mean of 5000 electrons over the picture: 3e-5
}

TEST(SimulatedCamera, IsoAndApertureScaleTheSignalAsAFilmWould) {
  UniformBench rig({0.4F, 0.4F, 0.4F}, {.sensor = {.dark_current_e_s = 0}});
  const double base = mean(exposed(*rig.camera, {.exposure_s = 0.25})) - 512;
  const double iso_400 = mean(exposed(*rig.camera, {.exposure_s = 0.25, .iso = 400})) - 512;
  const double f_16 = mean(exposed(*rig.camera, {.exposure_s = 0.25, .f_number = 16})) - 512;
  EXPECT_NEAR(iso_400 / base, 4, 8e-4);  // relative standard errors 3e-5 and 3e-5
  EXPECT_NEAR(f_16 / base, 0.25, 1e-4);  // a quarter of the electrons: 6e-5 of 0.25
}

TEST(SimulatedCamera, MoreLightThanTheWellHoldsReadsTheWhiteLevel) {
  UniformBench rig({2.0F, 2.0F, 2.0F});
  const cv::Mat1d picture = exposed(*rig.camera, {.exposure_s = 1});
  double low = 0, high = 0;
  cv::minMaxLoc(picture, &low, &high);
  EXPECT_EQ(low, 16383);
  EXPECT_EQ(high, 16383);
}

// Photon transfer: shot noise makes the variance grow with the signal, by the gain in DN per electron.
TEST(SimulatedCamera, VarianceGrowsWithTheMeanByTheGain) {
  for (const int iso : {100, 400}) {
    UniformBench rig({0.1F, 0.1F, 0.1F});
    const auto pair_at = [&](double exposure_s) {
      const rig::CameraSettings settings{.exposure_s = exposure_s, .iso = iso};
      return std::pair{exposed(*rig.camera, settings), exposed(*rig.camera, settings)};
    };
    const auto [dim, dim_again] = pair_at(0.1);
    const auto [bright, bright_again] = pair_at(1.0);
    const double slope = (variance(bright, bright_again) - variance(dim, dim_again)) / (mean(bright) - mean(dim));
    // A variance over N pixels has the relative standard error sqrt(2 / N) = 0.3 %; five of them.
    EXPECT_NEAR(slope / (kGain * iso / 100), 1, 0.015);
  }
}

TEST(SimulatedCamera, FewElectronsHaveTheVarianceOfTheirMeanOnBothSidesOfTheCountingLimit) {
  for (const double electrons : {20.0, 49.0, 51.0}) {
    const auto radiance = static_cast<float>(electrons / 50000);
    UniformBench rig({radiance, radiance, radiance}, {.sensor = {.read_noise_e = 0, .dark_current_e_s = 0}});
    const rig::CameraSettings settings{.exposure_s = 1, .iso = 25600};  // 81 DN per electron: rounding is nothing
    const double gain = 256 * kGain;
    const cv::Mat1d first = exposed(*rig.camera, settings), second = exposed(*rig.camera, settings);
    EXPECT_NEAR((mean(first) - 512) / gain, electrons, 5 * std::sqrt(electrons / kPixels));
    EXPECT_NEAR(variance(first, second) / (gain * gain * electrons), 1, 0.015);  // as above: five of 0.3 %
  }
}

TEST(SimulatedCamera, ADarkFrameHasTheBlackLevelAndTheReadNoise) {
  UniformBench rig({0, 0, 0});
  const cv::Mat1d dark = exposed(*rig.camera, {.exposure_s = 1 / 4000.0});
  const double expected = std::sqrt(std::pow(5 * kGain, 2) + 1 / 12.0);  // read noise and rounding
  EXPECT_NEAR(mean(dark), 512, 5 * expected / std::sqrt(kPixels));
  EXPECT_NEAR(standard_deviation(dark) / expected, 1, 5 / std::sqrt(2 * kPixels));
}

TEST(SimulatedCamera, ALongDarkFrameShowsTheDarkCurrent) {
  UniformBench rig({0, 0, 0});
  const double above = mean(exposed(*rig.camera, {.exposure_s = 30})) - 512;
  EXPECT_NEAR(above, 60 * kGain, 5 * std::sqrt(60 + 25) * kGain / std::sqrt(kPixels));
}

TEST(SimulatedCamera, EachPixelSeesOneColourOfRggb) {
  UniformBench rig({0.1F, 0.2F, 0.4F});
  const cv::Mat1d picture = exposed(*rig.camera, {.exposure_s = 1});
  const std::array<double, 4> expected{0.1, 0.2, 0.2, 0.4};
  for (int site = 0; site < 4; ++site) {
    double sum = 0;
    for (int row = site / 2; row < picture.rows; row += 2)
      for (int column = site % 2; column < picture.cols; column += 2) sum += picture(row, column) - 512;
    // Up to 20000 electrons over 60000 pixels: standard error 0.6 electrons, 0.2 DN; and the dark current.
    EXPECT_NEAR(sum / (kPixels / 4), expected[static_cast<std::size_t>(site)] * 15871 + 2 * kGain, 1.0);
  }
}

TEST(SimulatedCamera, TheCornersAreDarkerByTheVignetting) {
  UniformBench rig({0.5F, 0.5F, 0.5F}, {.lens = {.vignetting = {-0.3, 0.05}}, .sensor = {.dark_current_e_s = 0}});
  const cv::Mat1d picture(exposed(*rig.camera, {.exposure_s = 1}) - 512);
  const double centre = mean(picture(cv::Rect(290, 190, 20, 20)));
  double corners = 0;
  for (const cv::Point corner : {cv::Point(0, 0), cv::Point(580, 0), cv::Point(0, 380), cv::Point(580, 380)})
    corners += mean(picture(cv::Rect(corner, cv::Size(20, 20)))) / 4;
  // The middle of a corner patch is 290 px and 190 px from the centre; half the diagonal is 360.6 px.
  const double r2 = (290.0 * 290 + 190.0 * 190) / (300.0 * 300 + 200.0 * 200);
  // 400 pixels of 25000 electrons: standard error 3e-4; the patch's curvature is below 1e-3.
  EXPECT_NEAR(corners / centre, 1 - 0.3 * r2 + 0.05 * r2 * r2, 3e-3);
}

TEST(SimulatedCamera, TakesTheNearestTimeItOffersAndSaysSo) {
  UniformBench rig({0, 0, 0});
  EXPECT_EQ(rig.camera->configure({.exposure_s = 0.26}).exposure_s, 0.25);
  EXPECT_EQ(rig.camera->configure({.exposure_s = 1000}).exposure_s, 30);
  EXPECT_EQ(rig.camera->configure({.exposure_s = 1e-6}).exposure_s, 1 / 8000.0);
  EXPECT_EQ(rig.camera->configure({.f_number = 8.1}).f_number, 8);
}

TEST(SimulatedCamera, RefusesSettingsItDoesNotHaveAndKeepsTheOldOnes) {
  UniformBench rig({0, 0, 0});
  rig.camera->configure({.exposure_s = 0.5, .iso = 200});
  EXPECT_THROW(rig.camera->configure({.iso = 123}), std::runtime_error);
  EXPECT_THROW(rig.camera->configure({.iso = 51200}), std::runtime_error);
  EXPECT_THROW(rig.camera->configure({.exposure_s = -1}), std::runtime_error);
  EXPECT_THROW(rig.camera->configure({.f_number = std::numeric_limits<double>::quiet_NaN()}), std::runtime_error);
  const rig::Picture picture = rig.camera->capture();
  EXPECT_EQ(picture.settings.exposure_s, 0.5);
  EXPECT_EQ(picture.settings.iso, 200);
}

TEST(SimulatedCamera, AnExposureTakesItsTimeAndIsDatedAtItsBeginning) {
  UniformBench rig({0, 0, 0});
  rig.camera->configure({.exposure_s = 2.5});
  const std::string begin = rig.clock.utc();
  EXPECT_EQ(rig.camera->capture().utc, begin);
  EXPECT_EQ(rig.clock.monotonic_s(), 2.5);
}

TEST(SimulatedCamera, TheFileSaysWhatTheCameraSays) {
  UniformBench rig({0, 0, 0}, {.seed = 42});
  rig.camera->configure({.exposure_s = 1.3, .iso = 800, .f_number = 11});
  const ReadRaw raw = read_raw(rig.camera->capture().bytes);
  const rig::CameraIdentity identity = rig.camera->identity();
  EXPECT_EQ(raw.model, identity.model);
  EXPECT_EQ(raw.make, identity.make);
  EXPECT_EQ(raw.serial, identity.serial);
  EXPECT_EQ(raw.mosaic.size(), cv::Size(identity.width_px, identity.height_px));
  EXPECT_FLOAT_EQ(static_cast<float>(raw.exposure_s), 1.3F);
  EXPECT_EQ(raw.iso, 800);
  EXPECT_EQ(raw.f_number, 11);
}

TEST(SimulatedCamera, RepeatsItselfForTheSameSeedWhileEachPictureHasItsOwnNoise) {
  UniformBench one({0.2F, 0.2F, 0.2F}), same({0.2F, 0.2F, 0.2F}), other({0.2F, 0.2F, 0.2F}, {.seed = 2});
  const auto first = one.camera->capture().bytes;
  EXPECT_EQ(first, same.camera->capture().bytes);
  EXPECT_NE(first, other.camera->capture().bytes);
  EXPECT_NE(first, one.camera->capture().bytes);
}

TEST(SimulatedCamera, DrawsAgainOnlyWhenTheBenchHasChanged) {
  UniformBench rig({0.2F, 0.2F, 0.2F});
  rig.camera->capture();
  rig.camera->configure({.exposure_s = 1});
  rig.camera->capture();
  EXPECT_EQ(rig.drawings, 1);
  rig.bench.turn_platform(0.1);
  rig.camera->capture();
  EXPECT_EQ(rig.drawings, 2);
  rig.bench.place({.lamp = rig::Lamp::front});
  rig.camera->capture();
  rig.bench.place({.lamp = rig::Lamp::back});
  rig.camera->capture();
  EXPECT_EQ(rig.drawings, 4);
  rig.bench.place({.object = rig::BenchObject::holder, .on_platform = true, .lamp = rig::Lamp::back});
  rig.camera->capture();
  rig.camera->capture();
  EXPECT_EQ(rig.drawings, 5);
}

TEST(SimulatedCamera, LiveViewIsDrawnWhenTheBenchHasChanged) {
  std::vector<float> drawn_roughly;
  rig::SimulatedBench bench({}, [&](const rig::BenchState& state) {
    const auto angle = static_cast<float>(state.platform_angle_rad);
    if (state.roughly) drawn_roughly.push_back(angle);
    return cv::Mat3f(state.lens.height_px, state.lens.width_px, cv::Vec3f::all(0.1f + angle));
  });
  rig::SimulatedClock clock(0);
  const auto camera = rig::make_simulated_camera(bench, clock);
  const auto before = camera->preview();
  EXPECT_EQ(camera->preview(), before);
  camera->capture();
  EXPECT_EQ(camera->preview(), before);
  bench.turn_platform(0.5);
  camera->preview();
  bench.turn_platform(0);
  EXPECT_EQ(camera->preview(), before);
  EXPECT_EQ(drawn_roughly, (std::vector<float>{0, 0.5f, 0}));
}

TEST(SimulatedCamera, WhatTheDrawingThrowsReachesTheCallerAndTheNextPictureDrawsAgain) {
  int drawings = 0;
  rig::SimulatedBench bench({}, [&](const rig::BenchState& state) -> cv::Mat3f {
    if (++drawings == 2) throw std::domain_error("the scene is empty");
    return cv::Mat3f(state.lens.height_px, state.lens.width_px, cv::Vec3f::all(0));
  });
  rig::SimulatedClock clock(0);
  const auto camera = rig::make_simulated_camera(bench, clock);
  camera->capture();
  bench.turn_platform(1);
  EXPECT_THROW(camera->capture(), std::domain_error);
  bench.turn_platform(0);
  EXPECT_NO_THROW(camera->capture());
  EXPECT_EQ(drawings, 3);
}

TEST(SimulatedCamera, ADrawingOfTheWrongSizeOrWithoutNumbersIsRefused) {
  rig::SimulatedClock clock(0);
  rig::SimulatedBench small({}, [](const rig::BenchState&) { return cv::Mat3f(4, 4, cv::Vec3f::all(0)); });
  EXPECT_THROW(rig::make_simulated_camera(small, clock)->capture(), std::runtime_error);
  UniformBench nan({0, std::numeric_limits<float>::quiet_NaN(), 0});
  EXPECT_THROW(nan.camera->capture(), std::runtime_error);
}

TEST(SimulatedCamera, ASensorThatNoFileCouldHoldIsRefused) {
  rig::SimulatedClock clock(0);
  for (const rig::TrueSensor& sensor :
       {rig::TrueSensor{.white_level_dn = 15000}, rig::TrueSensor{.black_level_dn = 512.5},
        rig::TrueSensor{.black_level_dn = 17000}, rig::TrueSensor{.full_well_e = 0}}) {
    rig::SimulatedBench bench({.sensor = sensor}, nullptr);
    EXPECT_THROW(rig::make_simulated_camera(bench, clock), std::runtime_error);
  }
}

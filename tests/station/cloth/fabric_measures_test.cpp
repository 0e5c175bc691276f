// The repeat of a cloth from pictures of it: waves on a cylinder, drawn pixel by pixel without the renderer, of
// periods, noise and cameras drawn at random.
#include "station/cloth/fabric_measures.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <numbers>
#include <random>

#include "station/cloth/fabric_height.h"

namespace station {
namespace {

using Eigen::Vector3d;

constexpr unsigned kSeed = 20261203;
constexpr double kRadius_mm = 41.5, kFocal_px = 2300, kDistance_mm = 620;
constexpr int kWidth = 420, kHeight = 300;

struct Waves {
  double around_mm, along_mm, phase, strength, noise;
  bool diagonal;               // as of a twill, or along the axes
  double highlight_rad = 0.8;  // standard deviation of the slow brightness round the cylinder
};

double brightness(const Waves& waves, double around, double along) {
  const double x = 2 * std::numbers::pi * (around / waves.around_mm + waves.phase),
               y = 2 * std::numbers::pi * along / waves.along_mm;
  const double wave = waves.diagonal ? std::cos(x + y) + 0.5 * std::cos(x - y) : std::cos(x) + std::cos(y);
  return 1 + waves.strength * wave;
}

PhotographedCloth picture_of(const Waves& waves, double camera_rad, std::mt19937& random) {
  PhotographedCloth made{
      .image = cv::Mat3f(kHeight, kWidth, cv::Vec3f(0, 0, 0)),
      .mask = cv::Mat1b(kHeight, kWidth, uchar{0}),
      .camera = renderer::look_at(kDistance_mm * Vector3d(std::cos(camera_rad), std::sin(camera_rad), 0.3), {0, 0, 80},
                                  {0, 0, 1})};
  made.camera.width = kWidth, made.camera.height = kHeight;
  made.camera.fx = made.camera.fy = kFocal_px / 2;
  made.camera.cx = (kWidth - 1) / 2.0, made.camera.cy = (kHeight - 1) / 2.0;
  std::normal_distribution<double> noise(0, waves.noise);
  const Eigen::Matrix3d turn = made.camera.world_from_camera.linear();
  const Vector3d eye = made.camera.world_from_camera.translation();
  for (int row = 0; row < kHeight; ++row)
    for (int column = 0; column < kWidth; ++column) {
      // A ray against the cylinder x^2 + y^2 = r^2, by hand.
      const Vector3d d =
          turn * Vector3d((column - made.camera.cx) / made.camera.fx, (row - made.camera.cy) / made.camera.fy, 1);
      const double a = d.x() * d.x() + d.y() * d.y(), b = eye.x() * d.x() + eye.y() * d.y(),
                   c = eye.x() * eye.x() + eye.y() * eye.y() - kRadius_mm * kRadius_mm, square = b * b - a * c;
      if (square < 0) continue;
      const Vector3d at = eye + (-b - std::sqrt(square)) / a * d;
      if (at.z() < 10 || at.z() > 150) continue;
      const double facing = -(at.x() * d.x() + at.y() * d.y()) / (kRadius_mm * d.norm());
      if (facing < 0.3) continue;
      made.mask(row, column) = 255;
      const double angle = std::atan2(at.y(), at.x());
      // Shading that changes slowly, as of a highlight.
      const double light = 0.2 + std::exp(-0.5 * std::pow((angle - camera_rad) / waves.highlight_rad, 2));
      const auto value = static_cast<float>(light * (brightness(waves, kRadius_mm * angle, at.z()) + noise(random)));
      made.image(row, column) = cv::Vec3f(value, 0.5f * value, 0.2f * value);
    }
  return made;
}

TEST(FabricMeasures, TheRepeatIsFoundWithinItsErrors) {
  std::printf("seed %u\n", kSeed);
  std::mt19937 random(kSeed);
  const auto between = [&](double low, double high) { return std::uniform_real_distribution<>(low, high)(random); };
  for (int trial = 0; trial < 4; ++trial) {
    const Waves waves{.around_mm = between(2.2, 5),
                      .along_mm = between(2.2, 5),
                      .phase = between(0, 1),
                      .strength = between(0.02, 0.1),
                      .noise = between(0.05, 0.2),
                      .diagonal = trial % 2 == 1};
    std::vector<PhotographedCloth> pictures;
    for (int i = 0; i < 2; ++i) pictures.push_back(picture_of(waves, between(-0.3, 0.3), random));
    const PeriodSearch search{.crown_radius_mm = kRadius_mm,
                              .middle_radius_mm = kRadius_mm,
                              .around_mm = waves.around_mm * between(0.92, 1.08),
                              .along_mm = waves.along_mm * between(0.92, 1.08),
                              .scale_sigma = 0};
    const ClothPeriods found = measure_periods(pictures, search);
    ASSERT_TRUE(found.around_mm && found.along_mm) << trial;
    for (const auto& [measured, truth] :
         {std::pair{*found.around_mm, waves.around_mm}, {*found.along_mm, waves.along_mm}}) {
      std::printf("period %.4f: %.4f +- %.4f (%.1f deviations), %d waves\n", truth, measured.value, measured.sigma,
                  (measured.value - truth) / measured.sigma, found.waves);
      EXPECT_LT(std::abs(measured.value - truth), 4 * measured.sigma);
      EXPECT_LT(measured.sigma / truth, 0.005);
    }
  }
}

TEST(FabricMeasures, NoiseHasNoRepeat) {
  std::mt19937 random(kSeed);
  const Waves nothing{.around_mm = 3, .along_mm = 3, .phase = 0, .strength = 0, .noise = 0.2, .diagonal = false};
  const ClothPeriods found = measure_periods({picture_of(nothing, 0, random)}, {.around_mm = 3, .along_mm = 3});
  EXPECT_EQ(found.waves, 0);
  EXPECT_FALSE(found.around_mm || found.along_mm);
}

// Of the same width, whatever the brightness; the error is about as large as the found width is off.
TEST(FabricMeasures, AHighlightIsMostLikeOneOfItsWidth) {
  std::mt19937 random(kSeed + 1);
  const auto between = [&](double low, double high) { return std::uniform_real_distribution<>(low, high)(random); };
  for (int trial = 0; trial < 4; ++trial) {
    Waves waves{.around_mm = between(2.2, 5),
                .along_mm = between(2.2, 5),
                .phase = between(0, 1),
                .strength = 0.05,
                .noise = 0.1,
                .diagonal = false,
                .highlight_rad = between(0.25, 0.5)};
    const double truth = waves.highlight_rad, camera_rad = between(-0.3, 0.3);
    const auto profiles = [&](double times) {
      waves.highlight_rad = times * truth;
      PhotographedCloth picture = picture_of(waves, camera_rad, random);
      picture.image *= between(0.3, 3);
      return HighlightProfiles({picture}, kRadius_mm, waves.around_mm);
    };
    const HighlightProfiles photograph = profiles(1);
    std::vector<std::pair<double, double>> misfits;
    for (const double times : {0.6, 0.8, 0.95, 1.15, 1.4})
      misfits.emplace_back(times, photograph.misfit(profiles(times), -1));
    const auto found = lowest_place(misfits);
    ASSERT_TRUE(found);
    std::printf("highlight of %.3f rad: %.3f times as wide\n", truth, *found);
    EXPECT_NEAR(*found, 1, 0.05);
  }
}

TEST(FabricMeasures, TheLowestPlaceIsThatOfAParabola) {
  const auto line = [](double lowest, double above) {
    std::vector<std::pair<double, double>> points;
    for (const double x : {0.5, 0.7, 1.0, 1.1, 1.5}) points.emplace_back(x, above + 3 * (x - lowest) * (x - lowest));
    return points;
  };
  for (const double lowest : {0.75, 0.98, 1.2}) EXPECT_NEAR(lowest_place(line(lowest, 0.2)).value(), lowest, 1e-12);
  EXPECT_FALSE(lowest_place(line(0.4, 0))) << "it may lie lower than what was tried";
  EXPECT_FALSE(lowest_place(line(1.6, 0)));
}

}  // namespace
}  // namespace station

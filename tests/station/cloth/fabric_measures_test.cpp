// The repeat of a cloth from pictures of it: waves on a cylinder, drawn pixel by pixel without the renderer, of
// periods, noise and cameras drawn at random.
#include "station/cloth/fabric_measures.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <numbers>
#include <random>

namespace station {
namespace {

using Eigen::Vector3d;

constexpr unsigned kSeed = 20261203;
constexpr double kRadius_mm = 41.5, kFocal_px = 2300, kDistance_mm = 620;
constexpr int kWidth = 420, kHeight = 300;

struct Waves {
  double around_mm, along_mm, phase, strength, noise;
  bool diagonal;  // as of a twill, or along the axes
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
      const double light = 0.2 + std::pow(facing, 3);
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

}  // namespace
}  // namespace station

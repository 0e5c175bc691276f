#include "renderer/picture/denoise.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <array>
#include <cmath>
#include <cstdio>
#include <random>
#include <stdexcept>

#include "renderer/trace/path_tracer.h"
#include "tests/renderer/trace/cloth_scenes.h"

namespace {

using renderer::denoised;
using renderer::NoisyPicture;

constexpr int kWidth = 300, kHeight = 280;  // more than one part

// Stripes of two colours over a shade that grows to the right, as features and as their product.
struct Stripes {
  cv::Mat3f clean = cv::Mat3f(kHeight, kWidth);
  cv::Mat1f stripe = cv::Mat1f(kHeight, kWidth), shade = stripe.clone(), product = stripe.clone();
  Stripes() {
    clean.forEach([&](cv::Vec3f& pixel, const int* at) {
      stripe(at[0], at[1]) = (at[0] + 2 * at[1]) / 17 % 2 == 0 ? 1 : 0;
      shade(at[0], at[1]) = 0.5f + 0.5f * static_cast<float>(at[1]) / kWidth;
      product(at[0], at[1]) = shade(at[0], at[1]) * stripe(at[0], at[1]);
      pixel =
          shade(at[0], at[1]) * (stripe(at[0], at[1]) > 0 ? cv::Vec3f(0.8f, 0.3f, 0.2f) : cv::Vec3f(0.2f, 0.4f, 0.6f));
    });
  }
};

cv::Mat3f with_noise(const cv::Mat3f& clean, float deviation, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<float> normal(0, deviation);
  cv::Mat3f noisy = clean.clone();
  for (cv::Vec3f& pixel : noisy)
    for (int c = 0; c < 3; ++c) pixel[c] += normal(random);
  return noisy;
}

cv::Mat1f variance(float deviation) {
  return cv::Mat1f(kHeight, kWidth, 3 * deviation * deviation);
}

// Root mean square per pixel and colour.
double error(const cv::Mat3f& picture, const cv::Mat3f& truth) {
  return cv::norm(picture, truth, cv::NORM_L2) / std::sqrt(3.0 * static_cast<double>(truth.total()));
}

class Denoise : public testing::Test {
 protected:
  const unsigned seed_ = std::random_device{}();
  Denoise() { RecordProperty("seed", static_cast<int>(seed_)); }
};

TEST_F(Denoise, WhatTheFeaturesTellComesOutWithoutItsNoise) {
  SCOPED_TRACE("seed " + std::to_string(seed_));
  constexpr float kDeviation = 0.1f;
  const Stripes stripes;
  const cv::Mat3f noisy = with_noise(stripes.clean, kDeviation, seed_);
  const cv::Mat3f smooth = denoised(
      {.mean = noisy, .variance = variance(kDeviation), .features = {stripes.stripe, stripes.shade, stripes.product}});
  std::printf("%.3f of the noise is left\n", error(smooth, stripes.clean) / kDeviation);
  EXPECT_LT(error(smooth, stripes.clean), kDeviation / 8);
  const cv::Scalar difference = cv::mean(smooth) - cv::mean(noisy);
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(difference[c], 0, 0.002) << "no light is lost";
}

// Finer than any window, and nothing tells of it: it must not be taken for noise.
TEST_F(Denoise, AFineTextureStaysWhereTheNoiseIsSmall) {
  SCOPED_TRACE("seed " + std::to_string(seed_));
  constexpr float kDeviation = 0.02f;
  cv::Mat3f clean(kHeight, kWidth);
  clean.forEach(
      [](cv::Vec3f& pixel, const int* at) { pixel = cv::Vec3f::all((at[0] / 2 + at[1] / 2) % 2 == 0 ? 0.3f : 0.7f); });
  const cv::Mat3f noisy = with_noise(clean, kDeviation, seed_);
  const cv::Mat3f smooth = denoised({.mean = noisy, .variance = variance(kDeviation)});
  EXPECT_LT(error(smooth, clean), 1.1 * kDeviation);
}

TEST_F(Denoise, APictureWithoutNoiseStaysAsItIs) {
  const Stripes stripes;
  const cv::Mat3f same = denoised({.mean = stripes.clean, .variance = variance(0), .features = {stripes.shade}});
  EXPECT_LT(error(same, stripes.clean), 1e-6);
}

TEST_F(Denoise, IsTheSameByOneThreadAsByMany) {
  const Stripes stripes;
  const NoisyPicture picture{
      .mean = with_noise(stripes.clean, 0.1f, seed_), .variance = variance(0.1f), .features = {stripes.stripe}};
  const cv::Mat3f many = denoised(picture);
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  EXPECT_EQ(cv::norm(many, denoised(picture), cv::NORM_INF), 0);
}

// Cloth in two films of eight samples each, against 256 samples: close by, where highlights of five pixels are no
// linear functions of anything, and from afar.
TEST_F(Denoise, ClothComesNearerToItsTruth) {
  constexpr int kSide = 64;
  const auto seed = static_cast<std::uint64_t>(seed_);
  SCOPED_TRACE("seed " + std::to_string(seed));
  renderer::Scene scene = renderer::two_scale_scene(renderer::SwatchShape{.width_mm = 60, .height_mm = 60},
                                                    renderer::satin_patch(), renderer::red_and_blue_threads());
  scene.lights = {{.center = {60, -40, 90}, .radius_mm = 30, .visible = false}};
  const renderer::PathTracer tracer(std::move(scene));
  for (const auto& [width_mm, most] : {std::pair{6.0, 1.0}, {50.0, 0.65}}) {
    const renderer::Camera camera = renderer::camera_on({0, 0, 300}, {0, 0, 0}, {0, 1, 0}, width_mm, kSide, kSide);
    std::array<renderer::Film, 2> films{renderer::empty_film(kSide, kSide), renderer::empty_film(kSide, kSide)};
    for (std::size_t i = 0; i < films.size(); ++i)
      ASSERT_TRUE(tracer.refine(camera, {.samples_per_pixel = 8, .seed = 3 * seed + i}, films.at(i)));
    NoisyPicture noisy = renderer::noisy_picture(films[0], films[1]);
    noisy.features = renderer::features_of(tracer.layers(camera, {.samples_per_pixel = 16, .seed = 3 * seed}));
    const cv::Mat3f truth = tracer.render(camera, {.samples_per_pixel = 256, .seed = 3 * seed + 2});
    const double before = error(noisy.mean, truth), after = error(denoised(noisy), truth);
    std::printf("%g mm wide: error of 16 samples %.4f, denoised %.4f\n", width_mm, before, after);
    EXPECT_LT(after, most * before) << width_mm;
    EXPECT_NEAR(std::sqrt(cv::mean(noisy.variance)[0] / 3), before, 0.2 * before) << "what is known of the noise";
  }
}

TEST_F(Denoise, PlanesOfAnotherSizeAreRefused) {
  const Stripes stripes;
  EXPECT_THROW(denoised({.mean = stripes.clean, .variance = variance(0), .features = {cv::Mat1f(3, 3, 0.0f)}}),
               std::invalid_argument);
  EXPECT_THROW(denoised({.mean = stripes.clean, .variance = cv::Mat1f(3, 3, 0.0f)}), std::invalid_argument);
}

}  // namespace

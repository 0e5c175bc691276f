// Pictures in cloth: stored paths against the path tracer, their derivatives against differences, and pictures rendered
// from known absorption.
#include "inversion/texture/texture_fit.h"

#include <gtest/gtest.h>

#include <cmath>

#include "calibration/light/colour_chart.h"
#include "inversion/texture/texture_paths.h"
#include "inversion/texture/texture_shading.h"
#include "renderer/trace/path_tracer.h"
#include "renderer/weave/initial_patch.h"

namespace inversion {
namespace {

using Eigen::Vector3d;
using renderer::AbsorptionTexture;

TexturedCloth twill() {
  renderer::Draft draft = renderer::twill_draft(2, 2);
  for (renderer::YarnSystem* system : {&draft.warp, &draft.weft}) system->diameter_mm = 0.5, system->pitch_mm = 0.62;
  renderer::ThreadParameters thread;
  thread.beta = {0.5, 0.4, 0.2};
  return {renderer::initial_patch(draft), {4, 4}, {thread}};
}

AbsorptionTexture texture_of(const TexturedCloth& cloth, cv::Mat3f sigma_a) {
  return {.sigma_a = std::move(sigma_a),
          .texel_mm = {cloth.patch.period_x_mm / cloth.crossings.x(), cloth.patch.period_y_mm / cloth.crossings.y()}};
}

// Blocks of colours, each a few crossings wide, beside a slow change.
cv::Mat3f colours(int rows, int columns) {
  cv::Mat3f sigma_a(rows, columns);
  for (int r = 0; r < rows; ++r)
    for (int c = 0; c < columns; ++c) {
      const int block = (r / 6 + 3 * (c / 6)) % 5;
      const float slow = 0.05F + 0.6F * static_cast<float>(r) / static_cast<float>(rows);
      const std::array<cv::Vec3f, 5> of{cv::Vec3f(0.05F, 1.5F, 2), cv::Vec3f(slow, slow, slow),
                                        cv::Vec3f(1.8F, 0.3F, 0.1F), cv::Vec3f(0.1F, 0.1F, 0.9F), cv::Vec3f(2, 2, 2)};
      sigma_a(r, c) = of[static_cast<std::size_t>(block)];
    }
  return sigma_a;
}

// What the path tracer shows of one repeat of the texture under light of 1 from everywhere: one pixel per texel.
cv::Mat3f rendered(const TexturedCloth& cloth, const AbsorptionTexture& texture, int samples_per_pixel,
                   std::uint64_t seed) {
  const Vector3d size(texture.texel_mm.x() * texture.sigma_a.cols, texture.texel_mm.y() * texture.sigma_a.rows, 0);
  const Eigen::Vector2d margin(8 * cloth.patch.period_x_mm, 8 * cloth.patch.period_y_mm);
  renderer::Scene scene;
  renderer::Cloth woven{
      .patch = cloth.patch, .threads = {cloth.threads.begin(), cloth.threads.end()}, .absorption = texture};
  for (const auto& [x, y] :
       {std::pair(-margin.x(), -margin.y()), std::pair(size.x() + margin.x(), -margin.y()),
        std::pair(size.x() + margin.x(), size.y() + margin.y()), std::pair(-margin.x(), size.y() + margin.y())}) {
    woven.surface.vertices.push_back({x, y, 0});
    woven.surface.normals.push_back({0, 0, 1});
    woven.surface.patch_mm.push_back({x, y});
  }
  woven.surface.triangles = {{0, 1, 2}, {0, 2, 3}};
  scene.cloths = {woven};
  scene.surroundings = renderer::EnvironmentLight{.radiance = cv::Mat3f(8, 16, cv::Vec3f(1, 1, 1))};
  const double above = 1e3 * size.norm();
  renderer::Camera camera = renderer::look_at(size / 2 + Vector3d(0, 0, above), size / 2, {0, 1, 0});
  camera.width = texture.sigma_a.cols, camera.height = texture.sigma_a.rows;
  camera.fx = above / texture.texel_mm.x(), camera.fy = above / texture.texel_mm.y();
  camera.cx = (camera.width - 1) / 2.0, camera.cy = (camera.height - 1) / 2.0;
  return renderer::PathTracer(scene).render(camera, {.samples_per_pixel = samples_per_pixel, .seed = seed});
}

double delta_e(const cv::Vec3f& a, const cv::Vec3f& b) {
  const auto lab = [](const cv::Vec3f& rgb) {
    return calibration::lab_of_linear_srgb(
        Vector3d(static_cast<double>(rgb[0]), static_cast<double>(rgb[1]), static_cast<double>(rgb[2])));
  };
  return calibration::delta_e_2000(lab(a), lab(b));
}

double mean_delta_e(const cv::Mat3f& a, const cv::Mat3f& b) {
  double sum = 0;
  for (int r = 0; r < a.rows; ++r)
    for (int c = 0; c < a.cols; ++c) sum += delta_e(a(r, c), b(r, c));
  return sum / static_cast<double>(a.total());
}

// What the curves and the mixing of these paths make of a texture.
struct Shaded {
  TextureShading shading;
  std::vector<TexelState> states;
};
Shaded shaded(const TexturedCloth& cloth, const cv::Mat3f& sigma_a, int paths_per_crossing) {
  const std::vector<CrossingPaths> paths = trace_crossing_paths(cloth, paths_per_crossing, 5);
  const auto curves = crossing_curves(paths);
  std::vector<CrossingPaths> mixing;
  for (const CrossingPaths& of : paths) mixing.push_back(those_that_mix(of));
  Shaded made{TextureShading(mixing, cloth.crossings, sigma_a.size()), {}};
  for (int r = 0; r < sigma_a.rows; ++r)
    for (int c = 0; c < sigma_a.cols; ++c) {
      TexelState state;
      for (int channel = 0; channel < 3; ++channel) {
        const AbsorptionCurve& curve = curves[made.shading.crossing(r, c)][static_cast<std::size_t>(channel)];
        const auto s = static_cast<double>(sigma_a(r, c)[channel]);
        state.sigma_a[channel] = sigma_a(r, c)[channel];
        state.curve_reflectance[channel] = static_cast<float>(curve.reflectance(s));
        state.curve_slope[channel] = static_cast<float>(curve.slope(s));
      }
      made.states.push_back(state);
    }
  return made;
}

TEST(TextureShading, ShowsWhatThePathTracerShows) {
  const TexturedCloth cloth = twill();
  const cv::Mat3f sigma_a = colours(24, 24);
  const Shaded paths = shaded(cloth, sigma_a, 1 << 15);
  const cv::Mat3f by_paths = paths.shading.reflectance(paths.states, 8192, 0),
                  by_tracer = rendered(cloth, texture_of(cloth, sigma_a), 2048, 3);
  EXPECT_LT(mean_delta_e(by_paths, by_tracer), 0.6);  // the tracer's noise is 0.4 / sqrt(2)
  const cv::Scalar one = cv::mean(by_paths), other = cv::mean(by_tracer);
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(one[c] / other[c], 1, 0.004) << c;
}

TEST(TextureShading, DescentHasTheSlopesOfTheLoss) {
  const TexturedCloth cloth = twill();
  const cv::Mat3f sigma_a = colours(7, 9);
  Shaded at = shaded(cloth, sigma_a, 4096);
  const cv::Mat3f target(sigma_a.size(), cv::Vec3f(0.4F, 0.5F, 0.45F));
  const std::vector<Channels> weights(at.states.size(), Channels(1, 2, 3, 0));
  const TextureShading::Descent found = at.shading.descent(at.states, target, weights, 64, 1);
  for (const std::size_t texel : {0U, 20U, 31U, 62U})
    for (int c = 0; c < 3; ++c) {
      const auto loss = [&](float change) {  // of the unknown, along the tangent of its curve
        std::vector<TexelState> moved = at.states;
        moved[texel].curve_reflectance[c] += change;
        moved[texel].sigma_a[c] += change / moved[texel].curve_slope[c];
        return at.shading.descent(moved, target, weights, 64, 1).loss;
      };
      const float change = 5e-4F;
      const double slope = (loss(change) - loss(-change)) / (2 * static_cast<double>(change));
      const auto expected = static_cast<double>(2 * found.gradient[texel][c]);
      EXPECT_NEAR(slope, expected, 0.02 * std::abs(expected) + 2e-3) << texel << " " << c;
    }
}

TEST(TextureFit, AbsorptionThatIsKnownIsSeenAgain) {
  const TexturedCloth cloth = twill();
  // 3,072 samples: with 1,024 the noise of dark texels is as large as their distance from the darkest there is.
  const cv::Mat3f target = rendered(cloth, texture_of(cloth, colours(32, 32)), 3072, 3);
  const TextureFit fit = fit_texture(cloth, target, {});
  const double by_curves = mean_delta_e(rendered(cloth, fit.curve, 512, 11), target),
               refined = mean_delta_e(rendered(cloth, fit.refined, 512, 11), target);
  std::printf("CIEDE2000, in renderings: by the curves %.3f, refined %.3f (own figures %.3f, %.3f)\n", by_curves,
              refined, mean_delta_e(fit.curve_reflectance, target), mean_delta_e(fit.refined_reflectance, target));
  EXPECT_LT(refined, 1);
  EXPECT_LT(refined, 0.7 * by_curves);
  EXPECT_GT(cv::mean(fit.in_gamut)[0], 0.97 * 255);
}

TEST(TextureFit, WhatCannotBeHadIsMarkedAndLeavesTheRestAlone) {
  const TexturedCloth cloth = twill();
  cv::Mat3f wanted(20, 20, cv::Vec3f(0.5F, 0.5F, 0.5F));
  wanted(10, 10) = {1.5F, 0.5F, 0.5F};
  wanted(5, 5) = {0, 0, 0};
  const TextureFit fit = fit_texture(cloth, wanted, {});
  EXPECT_EQ(cv::countNonZero(fit.in_gamut), 400 - 2);
  EXPECT_EQ(fit.in_gamut(10, 10), 0);
  EXPECT_EQ(fit.in_gamut(5, 5), 0);
  EXPECT_NEAR(fit.refined.sigma_a(15, 15)[0], fit.curve.sigma_a(15, 15)[0], 0.05F);
  for (const cv::Vec3f& s : fit.refined.sigma_a)
    for (int c = 0; c < 3; ++c) EXPECT_TRUE(s[c] >= 0 && s[c] <= 12) << s;
}

TEST(TextureFit, PicturesOfAnySizeAndStopping) {
  const TexturedCloth cloth = twill();
  for (const cv::Size size : {cv::Size(1, 1), cv::Size(3, 1), cv::Size(2, 37)}) {
    const TextureFit fit = fit_texture(cloth, cv::Mat3f(size, cv::Vec3f(0.5F, 0.4F, 0.6F)), {.steps = 2});
    EXPECT_EQ(fit.refined.sigma_a.size(), size);
    EXPECT_LT(mean_delta_e(fit.refined_reflectance, cv::Mat3f(size, cv::Vec3f(0.5F, 0.4F, 0.6F))), 0.5) << size;
  }
  double last = 0;
  const auto stop = [&](double share) { return (last = share) < 0.3; };
  EXPECT_THROW(fit_texture(cloth, cv::Mat3f(8, 8, cv::Vec3f(0.5F, 0.5F, 0.5F)), {.progress = stop}),
               std::runtime_error);
  EXPECT_LT(last, 0.6);
}

}  // namespace
}  // namespace inversion

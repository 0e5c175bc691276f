// Cloth whose absorption is a texture.
#include <gtest/gtest.h>

#include "renderer/trace/path_tracer.h"
#include "tests/renderer/trace/cloth_scenes.h"

namespace renderer {
namespace {

using Eigen::Vector2d;
using Eigen::Vector2i;
using Eigen::Vector3d;

const SwatchShape kSwatch{7.2, 5.4};

cv::Mat3f picture_of(const std::optional<AbsorptionTexture>& absorption, const ThreadParameters& thread) {
  YarnPatch patch = plain_patch();
  for (Yarn& yarn : patch.yarns) yarn.thread = 0;
  Scene scene = two_scale_scene(kSwatch, patch, {thread});
  scene.cloths[0].absorption = absorption;
  scene.surroundings = EnvironmentLight{.radiance = cv::Mat3f(8, 16, cv::Vec3f(1, 1, 1))};
  const Camera camera = camera_on({0, 0, 300}, {0, 0, 0}, {0, 1, 0}, 7.2, 32, 24);
  return PathTracer(scene).render(camera, {.samples_per_pixel = 16});
}

TEST(AbsorptionTextures, TexelsAreCountedFromTheLowerLeftAndRepeat) {
  const AbsorptionTexture texture{.sigma_a = cv::Mat3f(3, 4), .texel_mm = {2, 5}};
  EXPECT_EQ(texture.texel_at({0.1, 0.1}), Vector2i(0, 2));
  EXPECT_EQ(texture.texel_at({7.9, 14.9}), Vector2i(3, 0));
  EXPECT_EQ(texture.texel_at({8.1, 15.1}), Vector2i(0, 2));
  EXPECT_EQ(texture.texel_at({-0.1, -0.1}), Vector2i(3, 0));
  EXPECT_EQ(texture.texel_at({-1e-300, 8000}), Vector2i(3, 1));
}

TEST(AbsorptionTextures, OneOfOneColourIsThatThreadBitForBit) {
  ThreadParameters white, red = white;
  red.sigma_a = {0.1, 1.2, 0.9};
  const cv::Mat3f texels(5, 7, cv::Vec3f(0.1F, 1.2F, 0.9F));
  const cv::Mat3f textured = picture_of(AbsorptionTexture{.sigma_a = texels}, white), dyed = picture_of({}, red);
  EXPECT_EQ(cv::norm(textured, dyed, cv::NORM_INF), 0);
  EXPECT_GT(cv::norm(textured, picture_of({}, white), cv::NORM_INF), 0.1);
}

TEST(AbsorptionTextures, ColoursLieWhereTheirTexelsDo) {
  // The patch begins at the lower left corner of a swatch: left half red, and blue at the top right.
  cv::Mat3f texels(2, 2, cv::Vec3f(0, 0, 0));
  texels(0, 0) = texels(1, 0) = {0, 3, 3};
  texels(0, 1) = {3, 3, 0};
  const cv::Mat3f picture =
      picture_of(AbsorptionTexture{.sigma_a = texels, .texel_mm = {kSwatch.width_mm / 2, kSwatch.height_mm / 2}}, {});
  const auto mean = [&](int x, int y) { return cv::mean(picture(cv::Rect(x, y, 12, 8))); };
  const cv::Scalar left = mean(2, 8), top_right = mean(18, 2), below = mean(18, 14);
  EXPECT_GT(left[0], 1.2 * left[2]);
  EXPECT_GT(top_right[2], 1.2 * top_right[0]);
  EXPECT_NEAR(below[0], below[2], 0.03);
}

TEST(AbsorptionTextures, AreRefusedWhereTheyMeanNothing) {
  EXPECT_THROW(picture_of(AbsorptionTexture{}, {}), std::runtime_error);
  EXPECT_THROW(picture_of(AbsorptionTexture{.sigma_a = cv::Mat3f(1, 1), .texel_mm = {0, 1}}, {}), std::runtime_error);
  Scene fibers = two_scale_scene(kSwatch, plain_patch(), {FiberParameters{}, FiberParameters{}});
  fibers.cloths[0].absorption = AbsorptionTexture{.sigma_a = cv::Mat3f(1, 1)};
  EXPECT_THROW(PathTracer{fibers}, std::runtime_error);
}

}  // namespace
}  // namespace renderer

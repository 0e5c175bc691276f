// Textures of a period: what arithmetic and the renderer's own furnace say of them, and that they repeat.
#include "station/cloth/export/cloth_bake.h"

#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/imgproc.hpp>

#include "station/cloth/export/pbr_maps.h"
#include "tests/renderer/trace/cloth_scenes.h"
#include "tests/station/cloth/export/exported_cloths.h"

namespace station_test {
namespace {

using namespace station;
using Eigen::Array3d;

BakedCloth baked(const ClothSample& cloth, cv::Size size = {36, 36}, int samples = 64) {
  return bake_cloth(cloth, {.size_px = size, .samples_per_texel = samples});
}

// The picture that begins half a period further, both ways.
template <class Picture>
Picture rolled(const Picture& picture) {
  Picture wide;
  cv::copyMakeBorder(picture, wide, 0, picture.rows / 2, 0, picture.cols / 2, cv::BORDER_WRAP);
  return wide({picture.cols / 2, picture.rows / 2, picture.cols, picture.rows}).clone();
}

TEST(ClothBake, OpacityIsTheCoverOfRoundStraightYarns) {
  const ClothSample cloth = plain_cloth(black_thread(), black_thread());
  const BakedCloth found = baked(cloth);
  const double hole = 1 - 0.5 / 0.9;
  EXPECT_NEAR(cv::mean(found.front.opacity)[0], 1 - hole * hole, 2e-3);  // 64 samples of a texel
  EXPECT_NEAR(cv::mean(found.back.opacity)[0], 1 - hole * hole, 2e-3);
  EXPECT_DOUBLE_EQ(found.width_mm, 1.8);
  EXPECT_DOUBLE_EQ(found.height_mm, 1.8);
}

TEST(ClothBake, LosslessYarnsSendBackOrLetThroughAllLightThatMeetsThem) {
  const ClothSample cloth = plain_cloth(renderer::lossless_thread(), renderer::lossless_thread());
  const BakedSide front = baked(cloth).front;
  for (int c = 0; c < 3; ++c)
    EXPECT_NEAR(cv::mean(front.reflectance)[c] + cv::mean(front.transmittance)[c], cv::mean(front.opacity)[0], 5e-3);
}

TEST(ClothBake, EightBitMapsShowTheFurnacesReflectanceAndTransmittance) {
  for (const ClothSample& cloth :
       {plain_cloth(red_thread(), renderer::ThreadParameters{}), satin_cloth(red_thread(), black_thread())}) {
    const BakedCloth found = baked(cloth, bake_size(cloth, 48));
    const GltfShader shader(GltfMaterial{.roughness = 0.5, .sheen = 0.3, .normal_scale = 0.6});
    const EvenLight even(shader);
    const std::vector<PbrTexel> texels = texels_of(maps_of(found.front, shader), 0.6);
    EvenLight::Seen mean{Array3d::Zero(), Array3d::Zero()};
    for (const PbrTexel& texel : texels) {
      const EvenLight::Seen seen = even.seen(texel);
      mean.reflectance += texel.opacity * seen.reflectance / static_cast<double>(texels.size());
      mean.transmittance += texel.opacity * seen.transmittance / static_cast<double>(texels.size());
    }
    const Array3d above = furnace(cloth, true), below = furnace(cloth, false);
    for (int c = 0; c < 3; ++c) {
      EXPECT_NEAR(mean.reflectance[c], above[c], 0.02 * above[c] + 1e-3) << cloth.name;
      EXPECT_NEAR(mean.transmittance[c], below[c], 0.05 * below[c] + 2e-3) << cloth.name;
    }
  }
}

TEST(ClothBake, BlackWarpAndWhiteWeftMakeTheWeavesOwnPattern) {
  const ClothSample cloth = plain_cloth(black_thread(), renderer::lossless_thread());
  const BakedCloth found = baked(cloth);
  const renderer::Draft draft = renderer::plain_draft();
  for (int pick = 0; pick < 2; ++pick)
    for (int end = 0; end < 2; ++end) {
      // The middle of the crossing: picks rise in the cloth, rows fall in the picture, and the back is turned left to
      // right.
      const int column = 18 * end + 9, row = 35 - (18 * pick + 9);
      const bool warp_on_face = draft.warp_over[static_cast<std::size_t>(pick)][static_cast<std::size_t>(end)];
      EXPECT_EQ(found.front.reflectance(row, column)[0] < 0.25, warp_on_face) << pick << ", " << end;
      EXPECT_EQ(found.back.reflectance(row, 35 - column)[0] < 0.25, !warp_on_face) << pick << ", " << end;
    }
}

TEST(ClothBake, NormalsLeanAwayFromTheYarnsMiddlesAndPointUpOnTheWhole) {
  const BakedCloth found = baked(plain_cloth(black_thread(), black_thread()));
  for (const BakedSide* side : {&found.front, &found.back}) {
    const cv::Scalar mean = cv::mean(side->normal);
    EXPECT_NEAR(mean[0], 0, 0.02);
    EXPECT_NEAR(mean[1], 0, 0.02);
    EXPECT_GT(mean[2], 0.6);
    double least = 0;
    cv::minMaxIdx(side->normal.reshape(1, static_cast<int>(side->normal.total())).col(2), &least);
    EXPECT_GT(least, 0);
  }
  // Both crossings of the lowest pick: to the right x rises on the warp, upwards y on the weft.
  const cv::Mat3f& normal = found.front.normal;
  for (int end = 0; end < 2; ++end) {
    const int middle = 18 * end + 9;
    if (renderer::plain_draft().warp_over[0][static_cast<std::size_t>(end)]) {
      EXPECT_GT(normal(26, middle + 3)[0], 0.3);
      EXPECT_LT(normal(26, middle - 3)[0], -0.3);
    } else {
      EXPECT_GT(normal(23, middle)[1], 0.3);
      EXPECT_LT(normal(29, middle)[1], -0.3);
    }
  }
}

TEST(ClothBake, HalfAPeriodFurtherItIsTheSamePictureSoThatNoSeamShows) {
  const ClothSample cloth = satin_cloth(red_thread(), black_thread());
  ClothSample moved = cloth;
  for (renderer::Yarn& yarn : moved.patch.yarns)
    for (Eigen::Vector3d& point : yarn.control_points)
      point -= Eigen::Vector3d(cloth.patch.period_x_mm / 2, -cloth.patch.period_y_mm / 2, 0);
  const BakedSide here = baked(cloth, {20, 40}, 256).front, there = baked(moved, {20, 40}, 256).front;
  // Differences of noise alone; a picture that saw a fiftieth too much would differ by 0.02 and more.
  EXPECT_LT(cv::norm(rolled(here.opacity), there.opacity, cv::NORM_L1) / (20 * 40), 0.004);
  EXPECT_LT(cv::norm(rolled(here.normal), there.normal, cv::NORM_L1) / (3.0 * 20 * 40), 0.01);
  EXPECT_LT(cv::norm(rolled(here.reflectance), there.reflectance, cv::NORM_L1) / (3.0 * 20 * 40),
            0.06 * mean_of(here.reflectance).mean());
}

TEST(ClothBake, TexelsAreAboutSquareAndMemoryGrowsWithThem) {
  const ClothSample cloth = satin_cloth(red_thread(), black_thread());
  EXPECT_EQ(bake_size(cloth, 512), cv::Size(256, 512));
  EXPECT_EQ(bake_bytes({512, 512}), 4 * bake_bytes({256, 256}));
}

}  // namespace
}  // namespace station_test

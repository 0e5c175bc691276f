#include "renderer/trace/layers.h"

#include <gtest/gtest.h>

#include <set>

#include "renderer/trace/path_tracer.h"
#include "tests/renderer/trace/cloth_scenes.h"

namespace renderer {
namespace {

using Eigen::Vector3d;

Camera above(double width_mm, int width_px = 48, int height_px = 32) {
  return camera_on({0, 0, 300}, {0, 0, 0}, {0, 1, 0}, width_mm, width_px, height_px);
}

TEST(LayersTest, ABodyShowsItsAlbedoNormalDepthAndCover) {
  // Tilted by 45 degrees, its right half out of the picture's right half.
  const TriangleMesh mesh{.vertices = {{-30, -30, -30}, {0, -30, 0}, {0, 30, 0}, {-30, 30, -30}},
                          .triangles = {{0, 1, 2}, {0, 2, 3}},
                          .albedo = cv::Mat3f(1, 1, cv::Vec3f(0.7f, 0.4f, 0.2f))};
  const PictureLayers layers = PathTracer({.meshes = {mesh}}).layers(above(40), {.samples_per_pixel = 16});
  EXPECT_LT(cv::norm(layers.albedo(16, 10) - cv::Vec3f(0.7f, 0.4f, 0.2f)), 1e-6);
  const auto slope = static_cast<float>(std::sqrt(0.5));
  EXPECT_LT(cv::norm(layers.normal(16, 10) - cv::Vec3f(-slope, 0, slope)), 1e-6);
  EXPECT_EQ(layers.cover(16, 10), 1);
  EXPECT_NEAR(layers.depth_mm(16, 23), 300.5, 0.5) << "the pixel left of the middle";
  EXPECT_EQ(layers.cover(16, 30), 0);
  EXPECT_EQ(layers.depth_mm(16, 30), 0);
  EXPECT_EQ(layers.model(16, 10), 0);
  EXPECT_EQ(layers.yarn(16, 10), 0);
}

TEST(LayersTest, AThreadsAlbedoIsWhatItKeepsOfUniformLight) {
  Scene scene = two_scale_scene(SwatchShape{20, 20}, satin_patch(), {lossless_thread(), lossless_thread()});
  const PictureLayers layers = PathTracer(scene).layers(above(10), {.samples_per_pixel = 16});
  EXPECT_NEAR(cv::mean(layers.albedo)[0] / cv::mean(layers.cover > 0)[0] * 255, 1, 5e-3);
  EXPECT_GT(cv::mean(layers.normal)[2], 0.5);
}

TEST(LayersTest, EveryYarnHasItsNumberInBothScales) {
  // Warp across the picture's columns, weft across its rows; the patch's corner at the lower left.
  for (const bool two_scale : {true, false}) {
    const SwatchShape shape{14.4, 14.4};
    const Scene scene = two_scale ? two_scale_scene(shape, plain_patch(), red_and_blue_threads())
                                  : brute_force_scene(shape, plain_patch(), red_and_blue_threads());
    const RayScene rays(scene);
    std::set<std::uint32_t> ids;
    for (int i = 0; i < 16; ++i) {
      for (int j = 0; j < 16; ++j) {
        // Over the crossing of warp i and weft j, whichever lies on top.
        const Vector3d at(-7.2 + 0.9 * (i + 0.5), -7.2 + 0.9 * (j + 0.5), 5);
        const std::optional<YarnPlace> place = rays.yarn_at({at.cast<float>(), {0, 0, -1}});
        ASSERT_TRUE(place);
        if (two_scale) {
          EXPECT_EQ(place->group, 0u);
          EXPECT_EQ(place->number, place->weft ? j : i);
        } else {
          const int across =
              place->group == 1 ? j : i;  // curve sets: warp, weft; of the patch's two yarns, one after the other
          EXPECT_EQ(place->number, across % 2 * 8 + across / 2);
        }
        ids.insert(packed_yarn(*place));
      }
    }
    EXPECT_EQ(ids.size(), 32u);
  }
}

TEST(LayersTest, APatchsYarnsAreToldApartWhateverTheirThreadAndSection) {
  YarnPatch patch = satin_patch();
  for (Yarn& yarn : patch.yarns)
    if (!yarn.warp) yarn.flatness = 1.5;
  Scene scene = two_scale_scene(SwatchShape{22, 22}, patch, red_and_blue_threads());
  scene.cloths.push_back({surface_of(SwatchShape{22, 22}, patch, Eigen::Isometry3d(Eigen::Translation3d(0, 0, -9))),
                          patch, red_and_blue_threads()});
  const RayScene rays(scene);
  std::set<int> warp, weft;
  for (int i = 0; i < 2000; ++i) {
    const Vector3d at(-11 + 22 * (i % 50 + 0.5) / 50, -11 + 22 * (i / 50 + 0.5) / 40, 5);
    const std::optional<YarnPlace> place = rays.yarn_at({at.cast<float>(), {0, 0, -1}});
    if (!place || place->group != 0) continue;
    (place->weft ? weft : warp).insert(place->number);
    const double pitch = place->weft ? 1.1 : 0.55, across = (place->weft ? at.y() : at.x()) + 11;
    EXPECT_NEAR(place->number + 0.5, across / pitch, 1.01) << "yarns wander by less than their pitch";
  }
  EXPECT_EQ(warp.size(), 40u);
  EXPECT_GE(weft.size(), 18u);
}

TEST(LayersTest, TheyDoNotDependOnTheNumberOfThreads) {
  const PathTracer tracer(two_scale_scene(SwatchShape{20, 20}, satin_patch(), red_and_blue_threads()));
  const PictureLayers one = tracer.layers(above(24), {.samples_per_pixel = 3, .threads = 1}),
                      two = tracer.layers(above(24), {.samples_per_pixel = 3, .threads = 2});
  EXPECT_EQ(cv::norm(one.albedo, two.albedo, cv::NORM_INF), 0);
  EXPECT_EQ(cv::norm(one.yarn, two.yarn, cv::NORM_INF), 0);
  std::set<int> models;
  for (const int model : one.model) models.insert(model);
  EXPECT_EQ(models, (std::set<int>{0, 1, 2}));
}

TEST(LayersTest, PackedYarnsAreAllDifferentAndNeverNothing) {
  std::set<std::uint32_t> ids;
  for (const std::uint32_t group : {0u, 1u, 31u})
    for (const bool weft : {false, true})
      for (const int number : {-(1 << 25), -1, 0, 1, (1 << 25) - 1}) ids.insert(packed_yarn({group, weft, number}));
  EXPECT_EQ(ids.size(), 30u);
  EXPECT_FALSE(ids.contains(0));
}

}  // namespace
}  // namespace renderer

// Cloth whose yarns are bundles of fibers: the reference of predictions, as a patch of fibers in two scales.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>

#include "renderer/scattering/fiber_bundle.h"
#include "renderer/trace/path_tracer.h"
#include "renderer/weave/woven_patch.h"
#include "tests/renderer/trace/cloth_scenes.h"

namespace renderer {
namespace {

YarnPatch patch_of_fibers(const YarnPatch& patch) {
  std::vector<Strands> bundles;
  for (std::size_t i = 0; i < patch.yarns.size(); ++i)
    bundles.push_back({.radius_mm = 0.06, .places = pack_fibers(0.25, 0.06, 0.002, 1000, 10, 1 + i)});
  return with_strands(patch, bundles);
}

TEST(FiberClothTest, InTwoScalesItIsThatOfTheExplicitFibersOfTenMillimetres) {
  const YarnPatch fibers = patch_of_fibers(plain_patch());
  const std::vector<ScatteringModel> models(
      2, FiberParameters{.eta = 1.55, .sigma_a = {0.3, 0.5, 1.2}, .beta_m = 0.4, .beta_n = 0.4});
  const Camera camera = camera_on({40, 20, 300}, {0, 0, 0}, {0, 1, 0}, 5, 32, 32);
  for (const double side : {1.0, -1.0}) {  // light in front, light behind
    cv::Scalar means[2], squares[2];
    constexpr int kPictures = 8;
    for (const bool two_scale : {false, true}) {
      Scene scene = two_scale ? two_scale_scene(SwatchShape{10, 10}, fibers, models)
                              : brute_force_scene(SwatchShape{10, 10}, fibers, models);
      scene.lights = {
          {.center = {-120, 90, side * 300}, .radius_mm = 30, .radiance = {100, 100, 100}, .visible = false}};
      const PathTracer tracer(std::move(scene));
      for (int i = 0; i < kPictures; ++i) {
        const cv::Scalar mean = cv::mean(
            tracer.render(camera, {.samples_per_pixel = 128, .seed = static_cast<std::uint64_t>(100 * two_scale + i)}));
        means[two_scale] += mean / kPictures, squares[two_scale] += mean.mul(mean) / kPictures;
      }
    }
    for (int c = 0; c < 3; ++c) {
      double variance = 0;
      for (int k = 0; k < 2; ++k) variance += (squares[k][c] - means[k][c] * means[k][c]) / (kPictures - 1);
      const double ratio = means[1][c] / means[0][c], error = std::sqrt(variance) / means[0][c];
      std::printf("light %s, channel %d: two scales / explicit fibers = %.4f +- %.4f\n",
                  side > 0 ? "in front" : "behind", c, ratio, error);
      EXPECT_LT(error, 0.005);
      EXPECT_NEAR(ratio, 1, 0.012);  // three standard errors
    }
  }
}

}  // namespace
}  // namespace renderer

// Mean radiance of cloth in two scales against the same cloth as explicit curves, from independent samples.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <tuple>

#include "renderer/trace/path_tracer.h"
#include "renderer/weave/patch_measures.h"
#include "tests/renderer/trace/cloth_scenes.h"

namespace renderer {
namespace {

using Eigen::Array3d;
using Eigen::Vector3d;

struct Estimate {
  Array3d mean = Array3d::Zero(), standard_error = Array3d::Zero();
};

// Mean over all pixels, from pictures with seeds of their own.
Estimate mean_radiance(const Scene& scene, const Camera& camera, int samples_per_pixel, std::uint64_t first_seed) {
  constexpr int kPictures = 16;
  const PathTracer tracer(scene);
  Array3d sum = Array3d::Zero(), squares = Array3d::Zero();
  for (int i = 0; i < kPictures; ++i) {
    const cv::Scalar mean = cv::mean(tracer.render(
        camera, {.samples_per_pixel = samples_per_pixel, .seed = first_seed + static_cast<std::uint64_t>(i)}));
    const Array3d value(mean[0], mean[1], mean[2]);
    sum += value, squares += value * value;
  }
  const Array3d mean = sum / kPictures;
  return {mean, ((squares / kPictures - mean * mean).max(0) / (kPictures - 1)).sqrt()};
}

struct Comparison {
  Array3d ratio, standard_error;  // of two scales to brute force
};

Comparison compare(const ClothShape& shape, const YarnPatch& patch, const std::vector<SphereLight>& lights,
                   const std::vector<TriangleMesh>& meshes, const Camera& camera, int samples_per_pixel) {
  Scene two_scale = two_scale_scene(shape, patch, red_and_blue_threads());
  Scene brute_force = brute_force_scene(shape, patch, red_and_blue_threads());
  for (Scene* scene : {&two_scale, &brute_force}) scene->lights = lights, scene->meshes = meshes;
  const Estimate a = mean_radiance(two_scale, camera, samples_per_pixel, 100),
                 b = mean_radiance(brute_force, camera, samples_per_pixel, 200);
  EXPECT_GT(b.mean.minCoeff(), 0);
  return {a.mean / b.mean, (a.standard_error.square() + b.standard_error.square()).sqrt() / b.mean};
}

void print(const std::string& what, const Comparison& found) {
  std::printf("%s: two scales / brute force = %.4f %.4f %.4f +- %.4f %.4f %.4f\n", what.c_str(), found.ratio[0],
              found.ratio[1], found.ratio[2], found.standard_error[0], found.standard_error[1],
              found.standard_error[2]);
}

SphereLight lamp(const Vector3d& center) {
  return {.center = center, .radius_mm = 30, .radiance = {100, 100, 100}, .visible = false};
}

TEST(ClothRadianceTest, OnAFlatSwatchItIsThatOfTheExplicitYarns) {
  for (const YarnPatch& patch : {plain_patch(), satin_patch()}) {
    for (const double side : {1.0, -1.0}) {  // light in front, light behind
      // 6 mm in the middle of 22 mm: borders are ten thicknesses away.
      const Comparison found = compare(SwatchShape{22, 22}, patch, {lamp({-120, 90, side * 300})}, {},
                                       camera_on({40, 20, 300}, {0, 0, 0}, {0, 1, 0}, 6, 32, 32), 64);
      print(patch.name + (side > 0 ? ", light in front" : ", light behind"), found);
      EXPECT_LT(found.standard_error.maxCoeff(), 0.003) << patch.name << ' ' << side;
      EXPECT_LT((found.ratio - 1).abs().maxCoeff(), 0.01) << patch.name << ' ' << side;
    }
  }
}

TEST(ClothRadianceTest, OnABlackCylinderItIsNearlyThatOfTheBentYarns) {
  // Samples, so that the standard error is below a third of what is asked of the ratio: open cloth is the noisiest.
  for (const auto& [patch, radius_mm, samples] :
       {std::tuple(plain_patch(), 12.0, 256), std::tuple(plain_patch(), 41.0, 256), std::tuple(satin_patch(), 41.0, 96),
        std::tuple(irregular_patch(), 12.0, 96), std::tuple(irregular_patch(), 41.0, 160)}) {
    const double height_mm = 5 * radius_mm, middle_mm = height_mm / 2;
    const CylinderShape cylinder{.radius_mm = radius_mm, .height_mm = height_mm};
    const CylinderShape inside{.radius_mm = radius_mm + surface_range(patch).low_mm - 0.05, .height_mm = height_mm};
    const Comparison found =
        compare(cylinder, patch, {lamp({400, -300, middle_mm + 90})},
                {body_of(inside, Eigen::Isometry3d::Identity(), {0, 0, 0})},
                camera_on({500, 0, middle_mm}, {0, 0, middle_mm}, {0, 0, 1}, 2.2 * radius_mm, 40, 20), samples);
    print(patch.name + " round a cylinder of " + std::to_string(static_cast<int>(radius_mm)) + " mm", found);
    EXPECT_LT(found.standard_error.maxCoeff(), 0.002);
    // Facets are flat; where the cloth is thick and open that shows. Yarns that are stretched with their surface make
    // the irregular cloth 1.7 % too bright at 12 mm.
    EXPECT_LT((found.ratio - 1).abs().maxCoeff(), patch.name == "irregular" ? 0.01 : 0.006) << patch.name << radius_mm;
  }
}

}  // namespace
}  // namespace renderer

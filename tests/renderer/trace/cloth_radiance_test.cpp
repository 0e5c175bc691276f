// Mean radiance of cloth in two scales against the same cloth as explicit curves, from independent samples.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>

#include "renderer/trace/path_tracer.h"
#include "tests/renderer/trace/cloth_scenes.h"

namespace renderer {
namespace {

using Eigen::Vector3d;

struct Estimate {
  double mean = 0, standard_error = 0;
};

// Mean over all pixels and channels, from pictures with seeds of their own.
Estimate mean_radiance(const Scene& scene, const Camera& camera, int samples_per_pixel, std::uint64_t first_seed) {
  constexpr int kPictures = 16;
  const PathTracer tracer(scene);
  double sum = 0, squares = 0;
  for (int i = 0; i < kPictures; ++i) {
    const cv::Scalar mean = cv::mean(tracer.render(
        camera, {.samples_per_pixel = samples_per_pixel, .seed = first_seed + static_cast<std::uint64_t>(i)}));
    const double value = (mean[0] + mean[1] + mean[2]) / 3;
    sum += value, squares += value * value;
  }
  const double mean = sum / kPictures;
  return {mean, std::sqrt(std::max(0.0, squares / kPictures - mean * mean) / (kPictures - 1))};
}

struct Comparison {
  double ratio, standard_error;  // of two scales to brute force
};

Comparison compare(const ClothShape& shape, const YarnPatch& patch, const std::vector<SphereLight>& lights,
                   const std::vector<TriangleMesh>& meshes, const Camera& camera, int samples_per_pixel) {
  Scene two_scale = two_scale_scene(shape, patch, red_and_blue_threads());
  Scene brute_force = brute_force_scene(shape, patch, red_and_blue_threads());
  for (Scene* scene : {&two_scale, &brute_force}) scene->lights = lights, scene->meshes = meshes;
  const Estimate a = mean_radiance(two_scale, camera, samples_per_pixel, 100),
                 b = mean_radiance(brute_force, camera, samples_per_pixel, 200);
  EXPECT_GT(b.mean, 0);
  return {a.mean / b.mean, std::hypot(a.standard_error, b.standard_error) / b.mean};
}

SphereLight lamp(const Vector3d& center) {
  return {.center = center, .radius_mm = 30, .radiance = {100, 100, 100}, .visible = false};
}

TEST(ClothRadianceTest, OnAFlatSwatchItIsThatOfTheExplicitYarns) {
  for (const YarnPatch& patch : {plain_patch(), satin_patch()}) {
    for (const double side : {1.0, -1.0}) {  // light in front, light behind
      // 6 mm in the middle of 22 mm: borders are ten thicknesses away.
      const Comparison found = compare(SwatchShape{22, 22}, patch, {lamp({-120, 90, side * 300})}, {},
                                       camera_on({40, 20, 300}, {0, 0, 0}, {0, 1, 0}, 6, 32, 32), 32);
      EXPECT_LT(found.standard_error, 0.003) << patch.name << ' ' << side;
      EXPECT_NEAR(found.ratio, 1, 0.01) << patch.name << ' ' << side;  // more than three standard errors
      std::printf("%s, light %s: two scales / brute force = %.4f +- %.4f\n", patch.name.c_str(),
                  side > 0 ? "in front" : "behind", found.ratio, found.standard_error);
    }
  }
}

TEST(ClothRadianceTest, OnABlackCylinderItIsNearlyThatOfTheBentYarns) {
  const CylinderShape cylinder{.radius_mm = 41, .height_mm = 60};
  const std::vector<TriangleMesh> body{
      body_of(CylinderShape{.radius_mm = 40.4, .height_mm = 60}, Eigen::Isometry3d::Identity(), {0, 0, 0})};
  const Camera camera = camera_on({500, 0, 30}, {0, 0, 30}, {0, 0, 1}, 90, 40, 20);
  for (const YarnPatch& patch : {plain_patch(), satin_patch()}) {
    const Comparison found = compare(cylinder, patch, {lamp({400, -300, 120})}, body, camera, 256);
    EXPECT_LT(found.standard_error, 0.002) << patch.name;
    // Yarns are stretched by 1 % at the outside, facets are flat.
    EXPECT_NEAR(found.ratio, 1, 0.01) << patch.name;
    std::printf("%s round a cylinder: two scales / brute force = %.4f +- %.4f\n", patch.name.c_str(), found.ratio,
                found.standard_error);
  }
}

}  // namespace
}  // namespace renderer

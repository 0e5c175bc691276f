// Laws that any picture of cloth must obey: energy that is kept stays, energy that is lost is lost once, periods and
// seams do not show, and no sample outshines its neighbours.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <map>
#include <random>

#include "renderer/picture/pixel_rays.h"
#include "renderer/scene/garment.h"
#include "renderer/trace/path_tracer.h"
#include "renderer/trace/path_vertex.h"
#include "renderer/trace/ray_scene.h"
#include "tests/renderer/trace/cloth_scenes.h"

namespace renderer {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;

// The lossless thread, of which a share of the light is lost at each scattering, alike in all directions.
ThreadParameters thread_of_albedo(double albedo) {
  ThreadParameters thread = lossless_thread();
  for (double* energy : {&thread.r0a, &thread.r0b, &thread.r0c, &thread.r1a}) *energy *= albedo;
  thread.r2b /= albedo;
  return thread;
}

// The mean over a picture of albedo^vertices for paths of the lossless thread that are drawn by scattering alone: what
// a cloth of that albedo shows in surroundings of radiance 1.
double walked_albedo(const Scene& lossless, const Camera& camera, double albedo, int walks_per_pixel) {
  const RayScene rays(lossless);
  const auto models = prepare_curve_models(scattering_models(lossless));
  const PixelRays pixels(camera, 0, 0, camera.width, camera.height);
  double sum = 0;
  for (int pixel = 0; pixel < camera.width * camera.height; ++pixel) {
    Sampler sampler(77, static_cast<std::uint64_t>(pixel));
    for (int walk = 0; walk < walks_per_pixel; ++walk) {
      sampler.start_sample(static_cast<std::uint32_t>(walk));
      const CameraRay start = pixels.at(pixel % camera.width, pixel / camera.width, sampler.next_2d());
      Ray ray{start.origin.cast<float>(), start.direction.cast<float>()};
      double weight = 1;
      for (int vertex = 0; vertex < 300; ++vertex) {
        const std::optional<SurfaceHit> hit = rays.intersect(ray);
        if (!hit) {
          sum += weight;
          break;
        }
        const PathVertex at(*hit, -ray.direction, models);
        const Vector3f wi = at.sample(sampler);
        const ScatteringValue<float> value = at.evaluate(wi);
        if (!(value.pdf > 0)) break;
        weight *= albedo * static_cast<double>(value.f_cos[0] / value.pdf);
        ray = at.ray_toward(wi, sampler).ray;
      }
    }
  }
  return sum / (static_cast<double>(camera.width) * camera.height * walks_per_pixel);
}

Camera close_up() {
  return camera_on({30, 20, 60}, {0, 0, 0}, {0, 1, 0}, 6, 24, 24);
}

TEST(ClothLawsTest, ClothOfThreadsThatLoseAShareShowsTheAlbedoOfItsPaths) {
  const SwatchShape swatch{30, 30};
  for (const YarnPatch& patch : {plain_patch(), satin_patch()}) {
    const Scene lossless = two_scale_scene(swatch, patch, {lossless_thread(), lossless_thread()});
    const double expected = walked_albedo(lossless, close_up(), 0.8, 200);
    Scene scene = two_scale_scene(swatch, patch, {thread_of_albedo(0.8), thread_of_albedo(0.8)});
    scene.lights = {{.radius_mm = 500}};
    const cv::Scalar mean = cv::mean(PathTracer(scene).render(close_up(), {.samples_per_pixel = 200}));
    std::printf("%s: albedo %.4f, expected %.4f\n", patch.name.c_str(), mean[0], expected);
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(mean[c], expected, 3e-3);  // three standard errors
    EXPECT_LT(expected, 0.8);                                          // light is scattered more than once
  }
}

TEST(ClothLawsTest, ClothGivesBackNoMoreLightThanFallsOnIt) {
  // Threads as fits leave them: energies whose sum exceeds 1 at grazing angles, no absorption.
  const ThreadParameters bright{.alpha = {0.05, 0.3, 0.1},
                                .beta = {0.1, 0.6, 0.1},
                                .r0a = 0.5,
                                .r0b = 0,
                                .r0c = 0.6,
                                .r1a = 0.9,
                                .r2a = 2,
                                .r2b = 1.5};
  const std::vector<ScatteringModel> kinds[] = {
      {ThreadParameters{}, ThreadParameters{}}, {bright, bright}, {FiberParameters{}, FiberParameters{.beta_m = 0.1}}};
  for (const auto& threads : kinds) {
    for (const ClothShape& shape : {ClothShape(SwatchShape{30, 30}), ClothShape(CylinderShape{12, 24})}) {
      const bool flat = std::holds_alternative<SwatchShape>(shape);
      Scene scene = two_scale_scene(shape, satin_patch(), threads);
      scene.lights = {{.radius_mm = 500}};
      const Camera camera = flat ? close_up() : camera_on({90, 0, 12}, {0, 0, 12}, {0, 0, 1}, 22, 24, 24);
      const cv::Mat3f picture = PathTracer(scene).render(camera, {.samples_per_pixel = 64});
      for (int c = 0; c < 3; ++c) EXPECT_LT(cv::mean(picture)[c], 1 + 2e-3);  // two standard errors
    }
  }
}

TEST(ClothLawsTest, MovedByWholePeriodsItIsTheSamePicture) {
  const YarnPatch patch = satin_patch();
  Scene scene = two_scale_scene(SwatchShape{30, 30}, patch, red_and_blue_threads());
  scene.lights = {{.center = {-120, 90, 300}, .radius_mm = 30, .radiance = {100, 100, 100}}};
  const RenderOptions options{.samples_per_pixel = 16};
  const cv::Mat3f original = PathTracer(scene).render(close_up(), options);
  for (Eigen::Vector2d& place : scene.cloths[0].surface.patch_mm)
    place += Eigen::Vector2d(-7 * patch.period_x_mm, 12 * patch.period_y_mm);
  const cv::Mat3f moved = PathTracer(scene).render(close_up(), options);
  int different = 0;
  for (int i = 0; i < 24 * 24; ++i)
    different += cv::norm(original(i / 24, i % 24) - moved(i / 24, i % 24)) > 1e-3 * cv::norm(original(i / 24, i % 24));
  EXPECT_LE(different, 24 * 24 / 20);  // pixels of which a path only touches a yarn
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(cv::mean(moved)[c] / cv::mean(original)[c], 1, 1e-3);
}

// Places along the one seam of the ready skirt, with the outward normal there, and places away from it.
struct SkirtPlaces {
  Scene scene;
  std::vector<std::pair<Vector3d, Vector3d>> seam, elsewhere;
};

SkirtPlaces skirt(const YarnPatch& patch, const std::vector<ScatteringModel>& threads) {
  static const auto mesh = std::make_shared<UvMesh>(garment_mesh(SkirtShape{}));
  const MeshShape shape{mesh, {.uv_mm = 1}, "skirt"};
  SkirtPlaces places{.scene = two_scale_scene(shape, patch, threads)};
  const ClothSurface& surface = places.scene.cloths[0].surface;
  std::map<std::tuple<double, double, double>, int> times;
  const auto key = [&](std::size_t i) {
    const Vector3d& p = surface.vertices[i];
    return std::tuple(p.x(), p.y(), p.z());
  };
  for (std::size_t i = 0; i < surface.vertices.size(); ++i) ++times[key(i)];
  const double top = 590, bottom = 10;  // away from the edges
  for (std::size_t i = 0; i < surface.vertices.size(); ++i) {
    if (surface.vertices[i].z() > top || surface.vertices[i].z() < bottom) continue;
    if (times[key(i)] > 1)
      places.seam.push_back({surface.vertices[i], surface.normals[i]});
    else if (i % 97 == 0)
      places.elsewhere.push_back({surface.vertices[i], surface.normals[i]});
  }
  return places;
}

TEST(ClothLawsTest, NoLightPassesTheSeamOfASkirtThatTheClothWouldStop) {
  // Yarns that touch their neighbours: only slanting ways lead through.
  const SkirtPlaces places = skirt(patch_of(plain_draft(), 0.52, 0.52), red_and_blue_threads());
  const RayScene rays(places.scene);
  std::mt19937 random(4);
  std::uniform_real_distribution<double> u(-1, 1);
  const auto open_share = [&](const auto& at) {
    int open = 0;
    constexpr int kRays = 40000;
    for (int i = 0; i < kRays; ++i) {
      const auto& [place, normal] = at[static_cast<std::size_t>(i) % at.size()];
      const Vector3d along = normal.unitOrthogonal(), across = normal.cross(along);
      const Vector3d through = place + 0.4 * (u(random) * along + u(random) * across);
      const Vector3d way = (-normal + 0.5 * u(random) * along + 0.5 * u(random) * across).normalized();
      open += !rays.occluded({(through - 3 * way).cast<float>(), way.cast<float>()}, 6);
    }
    return static_cast<double>(open) / kRays;
  };
  const double seam = open_share(places.seam), elsewhere = open_share(places.elsewhere);
  std::printf("share of rays that pass: seam %.4f, elsewhere %.4f\n", seam, elsewhere);
  EXPECT_NEAR(seam, elsewhere, 0.01);
}

TEST(ClothLawsTest, ASeamDisappearsInAWhiteEnvironment) {
  SkirtPlaces places = skirt(plain_patch(), {lossless_thread(), lossless_thread()});
  places.scene.lights = {{.radius_mm = 5000}};
  const PathTracer tracer(places.scene);
  for (std::size_t i = 20; i < places.seam.size(); i += places.seam.size() / 3) {
    const auto& [place, normal] = places.seam[i];
    const cv::Mat3f picture =
        tracer.render(camera_on(place + 60 * normal, place, {0, 0, 1}, 5, 24, 24), {.samples_per_pixel = 512});
    EXPECT_NEAR(cv::mean(picture)[0], 1, 5e-3);
    // A dark or bright line would be a column or two; the noise of a column is below 1 %.
    cv::Mat columns;
    cv::reduce(picture, columns, 0, cv::REDUCE_AVG);
    for (int c = 0; c < columns.cols; ++c) EXPECT_NEAR(columns.at<cv::Vec3f>(c)[0], 1, 0.03) << c;
  }
}

}  // namespace
}  // namespace renderer

#include "renderer/trace/path_tracer.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <thread>

#include "renderer/scattering/degree.h"
#include "renderer/trace/ray_scene.h"

namespace renderer {
namespace {

using Eigen::Vector3d;

Camera small_camera(const Vector3d& eye, double frame_width_mm, int width = 24, int height = 16) {
  Camera camera = look_at(eye, {0, 0, 0}, {0, 1, 0});
  camera.width = width, camera.height = height;
  camera.fx = camera.fy = width * eye.norm() / frame_width_mm;
  camera.cx = (width - 1) / 2.0, camera.cy = (height - 1) / 2.0;
  return camera;
}

// Threads across and along, so that light scatters many times before it leaves.
CurveSet crossed_threads(const ScatteringModel& scattering) {
  CurveSet set{.scattering = scattering};
  for (int i = -8; i <= 8; ++i) {
    const float at = 0.35f * static_cast<float>(i);
    set.add_clamped_curve({{-4, at, 0, 0.15f}, {4, at, 0, 0.15f}});
    set.add_clamped_curve({{at, -4, 0.31f, 0.15f}, {at, 4, 0.31f, 0.15f}});
  }
  return set;
}

TriangleMesh white_floor(float albedo) {
  return {.vertices = {{-50, -50, 0}, {50, -50, 0}, {50, 50, 0}, {-50, 50, 0}},
          .triangles = {{0, 1, 2}, {0, 2, 3}},
          .albedo = cv::Mat3f(1, 1, cv::Vec3f::all(albedo))};
}

// The floor's middle from `degrees` off its normal, towards +x.
Camera look_at_floor(double degrees) {
  const double angle = degrees * kDegree;
  return small_camera({20 * std::sin(angle), 0, 20 * std::cos(angle)}, 0.5);
}

double mean(const cv::Mat3f& image, int channel = 0) {
  return cv::mean(image)[channel];
}

TEST(PathTracerTest, WhiteFibersInAUniformEnvironmentDisappear) {
  const PathTracer tracer(
      {.curves = {crossed_threads(FiberParameters{.beta_m = 0.2, .beta_n = 0.3})}, .lights = {{.radius_mm = 500}}});
  const cv::Mat3f image = tracer.render(small_camera({0, 2, 20}, 4), {.samples_per_pixel = 256});
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(mean(image, c), 1, 3e-3);  // about three standard errors
}

TEST(PathTracerTest, ThreadsThatKeepAllEnergyInAUniformEnvironmentDisappear) {
  // Every lambda constant or linear in c such that their sum is 1; sampled with the floor.
  const ThreadParameters thread{
      .r0a = 0, .r0b = -0.5, .r0c = 0.9, .r1a = 0.5, .r2a = 0, .r2b = 10, .r2c = 0, .limit_energy = false};
  const PathTracer tracer({.curves = {crossed_threads(thread)}, .lights = {{.radius_mm = 500}}});
  const cv::Mat3f image = tracer.render(small_camera({0, 2, 20}, 4), {.samples_per_pixel = 256});
  EXPECT_NEAR(mean(image), 1, 3e-3);  // about three standard errors
}

TEST(PathTracerTest, YarnsOfOneWhiteFiberInAUniformEnvironmentDisappear) {
  const YarnParameters yarn{.fiber_count = 1, .radius_ratio = 1};  // more fibers lose a little energy
  const PathTracer tracer({.curves = {crossed_threads(yarn)}, .lights = {{.radius_mm = 500}}});
  const cv::Mat3f image = tracer.render(small_camera({0, 2, 20}, 4), {.samples_per_pixel = 256});
  EXPECT_NEAR(mean(image), 1, 3e-3);  // about three standard errors
}

TEST(PathTracerTest, WhiteBundlesInAUniformEnvironmentDisappear) {
  const BundleParameters bundle{.fiber = {.beta_m = 0.2, .beta_n = 0.3}};
  const PathTracer tracer({.curves = {crossed_threads(bundle)}, .lights = {{.radius_mm = 500}}});
  const cv::Mat3f image = tracer.render(small_camera({0, 2, 20}, 4), {.samples_per_pixel = 256});
  EXPECT_NEAR(mean(image), 1, 3e-3);  // about three standard errors
}

TEST(PathTracerTest, DiffuseFloorInAUniformEnvironmentShowsItsAlbedo) {
  const PathTracer tracer({.meshes = {white_floor(0.6f)}, .lights = {{.radius_mm = 500}}});
  EXPECT_NEAR(mean(tracer.render(small_camera({0, 2, 20}, 4), {.samples_per_pixel = 64})), 0.6, 3e-3);
}

TEST(PathTracerTest, ASurfacesReflectanceFactorScalesWhatItReflectsOfEachDirection) {
  // Lit at 45 degrees and seen at 60, on opposite sides: both strategies must know of it.
  TriangleMesh panel = white_floor(0.5f);
  const auto lit = [&] {
    const PathTracer tracer(
        {.meshes = {panel}, .lights = {{.center = {100, 0, 100}, .radius_mm = 40, .visible = false}}});
    return mean(tracer.render(look_at_floor(-60), {.samples_per_pixel = 256, .max_vertices = 1}));
  };
  const double lambertian = lit();
  panel.reflectance_factor = [](double cos_theta_i, double cos_theta_o, double cos_phi) {
    return 1 + cos_theta_i * cos_theta_i + 0.1 * cos_theta_o * cos_phi;
  };
  // 0.5 from incidence, averaged over a lamp of 16 degrees; 1 % for that and for noise
  EXPECT_NEAR(lit() / lambertian, 1 + 0.5 + 0.1 * 0.5 * -1, 0.015);
}

TEST(PathTracerTest, IrradianceOfASphereFollowsTheInverseSquareLaw) {
  for (double radius : {1.0, 60.0}) {  // the small one is found by light sampling, the large one by both strategies
    const PathTracer tracer(
        {.meshes = {white_floor(0.5f)},
         .lights = {{.center = {0, 0, 100}, .radius_mm = radius, .radiance = {4, 4, 4}, .visible = false}}});
    const cv::Mat3f image =
        tracer.render(small_camera({0, 15, 20}, 0.5), {.samples_per_pixel = 128, .max_vertices = 1});
    const double irradiance = 4 * std::numbers::pi * radius * radius / (100 * 100);
    EXPECT_NEAR(mean(image) / (0.5 / std::numbers::pi * irradiance), 1, 3e-3)
        << radius;  // three standard errors, 0.5 mm wide frame
  }
}

TEST(PathTracerTest, TwoLightsAddUp) {
  const SphereLight a{.center = {0, 40, 80}, .radius_mm = 30},
      b{.center = {50, 0, 60}, .radius_mm = 2, .radiance = {90, 80, 70}};
  const auto lit_by = [&](const std::vector<SphereLight>& lights) {
    const PathTracer tracer(
        {.curves = {crossed_threads(FiberParameters{.sigma_a = {0.2, 0.2, 0.2}})}, .lights = lights});
    return mean(tracer.render(small_camera({0, 2, 20}, 4), {.samples_per_pixel = 512}));
  };
  const double both = lit_by({a, b});
  EXPECT_NEAR(lit_by({a}) + lit_by({b}), both, 0.02 * both);  // four standard errors
}

// One vertex on one convex thread: the light passes the thread's own far side, so the mean radiance of the upper or
// lower half of the thread is the mean of f_cos over its offsets. Fixes the signs of h and of all frames.
TEST(PathTracerTest, SingleScatteringOfOneThreadIsTheMeanOverOffsets) {
  const FiberParameters fiber{.sigma_a = {0.1, 0.3, 0.8}, .beta_m = 0.3, .beta_n = 0.2};
  CurveSet set{.scattering = fiber};
  set.add_clamped_curve({{-30, 0, 0, 0.1f}, {30, 0, 0, 0.1f}});
  const FiberModel<double> model(fiber);
  for (const Vector3d& toward_light : {Vector3d(0.3, 0.8, 0.5), Vector3d(-0.2, -0.3, 0.9), Vector3d(0.1, 0.3, -0.9)}) {
    const Vector3d light = toward_light.normalized();
    const double omega = std::numbers::pi * 1e-4;  // solid angle of a sphere of radius 40 at 4000
    const PathTracer tracer({.curves = {set}, .lights = {{.center = 4000 * light, .radius_mm = 40, .visible = false}}});
    const cv::Mat3f image =
        tracer.render(small_camera({0, 0, 1000}, 0.2, 8, 8), {.samples_per_pixel = 2000, .max_vertices = 1});
    const auto expected_half = [&](double side) {
      Eigen::Array3d sum = Eigen::Array3d::Zero();
      constexpr int kSteps = 1000;
      for (int i = 0; i < kSteps; ++i) {
        const double y = side * (i + 0.5) / kSteps;  // height on the thread, in radii
        const Vector3d normal(0, y, std::sqrt(1 - y * y)), tangent = Vector3d::UnitX(), across = normal.cross(tangent);
        const auto local = [&](const Vector3d& w) { return Vector3d(w.dot(tangent), w.dot(across), w.dot(normal)); };
        const Vector3d wo = local(Vector3d::UnitZ());
        sum += model.lobes_at(-wo.y(), wo).evaluate(local(light)).f_cos * (omega / kSteps);
      }
      return sum;
    };
    const Eigen::Array3d upper = expected_half(1), lower = expected_half(-1);
    for (int c = 0; c < 3; ++c) {
      const double tolerance = 3e-3 * (upper[c] + lower[c]);  // noise; the brighter half decides it
      EXPECT_NEAR(mean(image.rowRange(0, 4), c), upper[c], tolerance) << light.transpose();
      EXPECT_NEAR(mean(image.rowRange(4, 8), c), lower[c], tolerance) << light.transpose();
    }
  }
}

TEST(PathTracerTest, ThePictureDoesNotDependOnTheNumberOfThreads) {
  const PathTracer tracer(
      {.curves = {crossed_threads(FiberParameters{})}, .lights = {{.center = {0, 40, 80}, .radius_mm = 30}}});
  const Camera camera = small_camera({0, 2, 20}, 6, 40, 40);
  const cv::Mat3f one = tracer.render(camera, {.samples_per_pixel = 2, .threads = 1});
  EXPECT_EQ(cv::norm(one, tracer.render(camera, {.samples_per_pixel = 2, .threads = 3}), cv::NORM_INF), 0);
  EXPECT_GT(cv::norm(one, tracer.render(camera, {.samples_per_pixel = 2, .seed = 2}), cv::NORM_INF), 0);
}

TEST(PathTracerTest, OnlyTheAskedRegionIsRenderedAndItIsTheSamePicture) {
  const PathTracer tracer({.curves = {crossed_threads(FiberParameters{})}, .lights = {{.radius_mm = 500}}});
  const Camera camera = small_camera({0, 2, 20}, 6, 40, 40);
  cv::Mat1b region(40, 40, uchar{0});
  region(cv::Rect(10, 20, 15, 5)) = 255;
  const cv::Mat3f part = tracer.render(camera, {.samples_per_pixel = 2, .only = region});
  cv::Mat3f expected(40, 40, cv::Vec3f(0, 0, 0));
  tracer.render(camera, {.samples_per_pixel = 2}).copyTo(expected, region);
  EXPECT_EQ(cv::norm(part, expected, cv::NORM_INF), 0);
  EXPECT_THROW(tracer.render(camera, {.only = cv::Mat1b(3, 3)}), std::runtime_error);
}

TEST(PathTracerTest, StatisticsCountSamplesAndRays) {
  RenderStatistics statistics;
  const RenderOptions options{.samples_per_pixel = 3, .max_vertices = 1, .statistics = &statistics};
  PathTracer({.meshes = {white_floor(0.5f)}, .lights = {{.center = {0, 0, 100}, .radius_mm = 20}}})
      .render(small_camera({0, 0, 20}, 4), options);
  EXPECT_EQ(statistics.samples, 24u * 16 * 3);
  // The floor, the light, and what the scattered ray meets where that can still be a light.
  EXPECT_GE(statistics.rays, 2 * statistics.samples);
  EXPECT_LE(statistics.rays, 3 * statistics.samples);
  PathTracer(Scene{}).render(small_camera({0, 0, 20}, 4), options);
  EXPECT_EQ(statistics.rays, 0u);
}

TEST(PathTracerTest, LightsAreSeenByCamerasOnlyWhenVisible) {
  SphereLight light{.radius_mm = 20, .radiance = {7, 6, 5}};
  const Camera camera = small_camera({0, 0, 100}, 10);
  EXPECT_NEAR(mean(PathTracer({.lights = {light}}).render(camera, {}), 2), 5, 1e-6);
  light.visible = false;
  EXPECT_EQ(mean(PathTracer({.lights = {light}}).render(camera, {})), 0);
}

// A lamp smaller than a pixel, before and behind the plane of focus, and in it.
TEST(PathTracerTest, APointOutOfFocusIsSpreadOverItsCircleOfConfusion) {
  Camera camera = look_at({0, 0, 500}, {0, 0, 0}, {0, 1, 0});
  camera.width = 48, camera.height = 40;
  camera.fx = camera.fy = 1500, camera.cx = 23.5, camera.cy = 19.5;
  camera.aperture_mm = 20, camera.focus_mm = 500;
  for (const double depth_mm : {350.0, 500.0, 900.0}) {
    const Vector3d at(0.003 * depth_mm, -0.002 * depth_mm, 500 - depth_mm);  // 4.5 and 3 pixels beside the middle
    const double radius_mm = 3e-4 * depth_mm;                                // 0.45 pixels
    const PathTracer tracer({.lights = {{.center = at, .radius_mm = radius_mm}}});
    const cv::Mat3f image = tracer.render(camera, {.samples_per_pixel = 4096});
    double sum = 0, farthest = 0;
    Eigen::Vector2d mean = Eigen::Vector2d::Zero(), spread = Eigen::Vector2d::Zero();
    const Eigen::Vector2d expected = project(camera, at);
    for (int row = 0; row < camera.height; ++row) {
      for (int column = 0; column < camera.width; ++column) {
        const double light = image(row, column)[0];
        const Eigen::Vector2d from = Eigen::Vector2d(column, row) - expected;
        sum += light, mean += light * from, spread += light * from.cwiseAbs2();
        if (light > 0) farthest = std::max(farthest, from.norm());
      }
    }
    EXPECT_NEAR(sum, std::numbers::pi * 0.45 * 0.45, 0.06 * sum)
        << depth_mm;                                  // all of its light; 2600 rays meet the lamp
    EXPECT_LT((mean / sum).norm(), 0.4) << depth_mm;  // of 26 pixels, as many rays
    const double diameter = circle_of_confusion_px(camera, depth_mm);
    EXPECT_DOUBLE_EQ(diameter, 1500 * 20 * std::abs(1 / 500.0 - 1 / depth_mm));
    EXPECT_LT(farthest, diameter / 2 + 1.5);  // the lamp's own radius and the pixels'
    EXPECT_GT(farthest, diameter / 2 - 1.5);
    if (diameter == 0) continue;
    const double moment = diameter * diameter / 16;  // of a disc along an axis
    for (int axis = 0; axis < 2; ++axis) EXPECT_NEAR(spread[axis] / sum, moment, 0.05 * moment) << depth_mm;
  }
}

TEST(PathTracerTest, AnOpaqueFloorHidesTheLightBehindIt) {
  const PathTracer tracer({.meshes = {white_floor(0.5f)}, .lights = {{.center = {0, 0, -100}, .radius_mm = 20}}});
  EXPECT_EQ(mean(tracer.render(small_camera({0, 0, 100}, 10), {})), 0);
}

TEST(PathTracerTest, ThinFibersFarAwayKeepTheirWidth) {
  CurveSet set;
  set.add_clamped_curve({{-30, 0, 0, 0.05f}, {30, 0, 0, 0.05f}});
  const PathTracer tracer({.curves = {set}});
  for (double distance_mm : {600.0, 2e6}) {  // at 2 km a float has steps of 0.1 mm
    // 0.01 mm per pixel, seen obliquely: no coordinate of the rays is small
    const Camera camera = small_camera({0, 0.6 * distance_mm, 0.8 * distance_mm}, 0.3, 30, 20);
    const cv::Mat1b coverage = tracer.curve_coverage(camera, 1);
    EXPECT_EQ(cv::countNonZero(coverage), 30 * 10);
    EXPECT_EQ(coverage(4, 15), 0);
    EXPECT_EQ(coverage(5, 15), 255);
  }
}

TEST(PathTracerTest, CoverageOfSubPositionsIncludesPixelsThatAreOnlyTouched) {
  CurveSet set;
  set.add_clamped_curve({{-30, 0, 0, 0.052f}, {30, 0, 0, 0.052f}});
  const PathTracer tracer({.curves = {set}});
  const Camera camera = small_camera({0, 0, 600}, 0.3, 30, 20);
  EXPECT_EQ(cv::countNonZero(tracer.curve_coverage(camera, 1)), 30 * 10);
  EXPECT_EQ(cv::countNonZero(tracer.curve_coverage(camera, 64)), 30 * 12);
}

TEST(PathTracerTest, MeshesInFrontAreNotCoverage) {
  CurveSet set;
  set.add_clamped_curve({{-30, 0, -1, 0.05f}, {30, 0, -1, 0.05f}});
  const PathTracer tracer({.curves = {set}, .meshes = {white_floor(0.5f)}});
  EXPECT_EQ(cv::countNonZero(tracer.curve_coverage(small_camera({0, 0, 600}, 0.3), 1)), 0);
}

TEST(PathTracerTest, CurvesThatArePlacedElsewhereAreCovered) {
  CurveSet set;
  set.add_clamped_curve({{-0.5f, 0, 0, 0.2f}, {0.5f, 0, 0, 0.2f}});
  set.placed = Eigen::Translation3f(0.6f, 0.3f, 0) * Eigen::AngleAxisf(1.2f, Vector3d::UnitZ().cast<float>()) *
               Eigen::Scaling(1.0f, 2.0f, 1.0f);
  const Camera camera = small_camera({0, 0, 600}, 4, 80, 60);
  const Scene scene{.curves = {set}, .meshes = {white_floor(0.5f)}};
  const cv::Mat1b coverage = PathTracer(scene).curve_coverage(camera, 1);
  const RayScene rays(scene);
  cv::Mat1b met(coverage.size());
  for (int row = 0; row < met.rows; ++row)
    for (int column = 0; column < met.cols; ++column) {
      const CameraRay ray = ray_through(camera, column, row);
      met(row, column) = rays.meets_curve_first({ray.origin.cast<float>(), ray.direction.cast<float>()}) ? 255 : 0;
    }
  EXPECT_GT(cv::countNonZero(met), 200);
  EXPECT_EQ(cv::countNonZero(coverage != met), 0);
}

// Light comes by both strategies, so that half of it passes the lot by which a dark surface sends paths on.
TEST(PathTracerTest, ADarkFloorInAUniformEnvironmentIsAsBrightAsItsAlbedo) {
  for (const float albedo : {0.03f, 0.2f}) {
    const PathTracer tracer({.meshes = {white_floor(albedo)}, .lights = {{.radius_mm = 500}}});
    const cv::Mat3f image = tracer.render(look_at_floor(20), {.samples_per_pixel = 256});
    EXPECT_NEAR(mean(image) / static_cast<double>(albedo), 1, 5e-3) << albedo;
  }
}

TEST(PathTracerTest, ProgressIsReportedFromTheCallingThreadAndCanStop) {
  const PathTracer tracer({.lights = {{.radius_mm = 20}}});
  const Camera camera = small_camera({0, 0, 100}, 10, 200, 200);
  int calls = 0;
  const auto caller = std::this_thread::get_id();
  const auto count = [&](double fraction) {
    EXPECT_EQ(std::this_thread::get_id(), caller);
    EXPECT_TRUE(fraction > 0 && fraction <= 1);
    ++calls;
    return true;
  };
  tracer.render(camera, {.progress = count});
  EXPECT_GT(calls, 0);
  EXPECT_THROW(tracer.render(camera, {.progress = [](double) { return false; }}), std::runtime_error);
}

TEST(PathTracerTest, AnEmptySceneIsBlack) {
  EXPECT_EQ(mean(PathTracer(Scene{}).render(small_camera({0, 0, 100}, 10), {})), 0);
}

}  // namespace
}  // namespace renderer

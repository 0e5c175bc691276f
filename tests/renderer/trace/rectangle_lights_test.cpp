#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>

#include "renderer/scattering/degree.h"
#include "renderer/trace/lights.h"
#include "renderer/trace/path_tracer.h"
#include "renderer/trace/rectangle_light.h"

namespace renderer {
namespace {

using Eigen::Vector3d;

// Bright downwards, 60 x 25 mm, 40 mm over the origin and beside it.
RectangleLight panel() {
  return {.center = {15, -8, 40}, .edge_x = {0, 25, 0}, .edge_y = {60, 0, 0}, .radiance = {3, 2, 1}};
}

// Tilted by 50 degrees about y.
RectangleLight tilted_panel() {
  const double angle = 50 * kDegree;
  return {.center = {-30, 5, 35}, .edge_x = {0, 30, 0}, .edge_y = 20 * Vector3d(std::cos(angle), 0, std::sin(angle))};
}

std::array<Vector3d, 4> corners(const RectangleLight& light) {
  const Vector3d x = light.edge_x / 2, y = light.edge_y / 2;
  return {light.center - x - y, light.center + x - y, light.center + x + y, light.center - x + y};
}

// Lambert's closed form for a polygon above the horizon [Lambert 1760; Arvo 1994]: on a surface with unit normal
// `normal`.
double irradiance(const RectangleLight& light, const Vector3d& point, const Vector3d& normal) {
  const std::array<Vector3d, 4> at = corners(light);
  double sum = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    const Vector3d a = (at.at(i) - point).normalized(), b = (at.at((i + 1) % 4) - point).normalized();
    sum += std::acos(a.dot(b)) * a.cross(b).normalized().dot(normal);
  }
  return light.radiance.x() / 2 * std::abs(sum);
}

// Of two triangles [van Oosterom and Strackee 1983].
double expected_solid_angle(const RectangleLight& light, const Vector3d& point) {
  const std::array<Vector3d, 4> at = corners(light);
  const auto of_triangle = [&](std::size_t i, std::size_t j, std::size_t k) {
    const Vector3d a = (at.at(i) - point).normalized(), b = (at.at(j) - point).normalized(),
                   c = (at.at(k) - point).normalized();
    return 2 * std::atan2(std::abs(a.dot(b.cross(c))), 1 + a.dot(b) + b.dot(c) + c.dot(a));
  };
  return of_triangle(0, 1, 2) + of_triangle(0, 2, 3);
}

const std::array<Vector3d, 5> kPoints{Vector3d(0, 0, 0), Vector3d(15, -8, 39.9), Vector3d(200, 100, -30),
                                      Vector3d(40, 3, 30), Vector3d(3e4, 0, -1e5)};

TEST(RectangleLightsTest, TheSolidAngleIsThatOfItsTwoTrianglesBeforeItAndNoneBehind) {
  for (const Vector3d& point : kPoints) {
    const double expected = expected_solid_angle(panel(), point);
    EXPECT_NEAR(solid_angle(panel(), point), expected, 1e-6 * expected + 1e-14) << point.transpose();
  }
  EXPECT_EQ(solid_angle(panel(), {0, 0, 41}), 0);
}

TEST(RectangleLightsTest, DirectionsAreDrawnEvenlyOverTheSolidAngle) {
  const Lights light({.rectangles = {panel()}});
  constexpr int kSide = 64;
  for (const Vector3d& point : kPoints) {
    // The mean direction is the boundary integral of Lambert's form, component by component.
    Vector3d mean = Vector3d::Zero(), expected;
    for (int i = 0; i < kSide * kSide; ++i) {
      const Eigen::Vector2f u = (Eigen::Vector2i(i % kSide, i / kSide).cast<float>().array() + 0.5f) / kSide;
      const auto direction = light.sample(point, 0.3f, u);
      ASSERT_TRUE(direction);
      EXPECT_TRUE(light.intersect(point, *direction, false));
      EXPECT_NEAR(light.pdf(point, *direction) * solid_angle(panel(), point), 1, 1e-9);
      mean += *direction / (kSide * kSide);
    }
    const double sr = solid_angle(panel(), point);
    for (int axis = 0; axis < 3; ++axis) {
      const std::array<Vector3d, 4> at = corners(panel());
      double sum = 0;
      for (std::size_t i = 0; i < 4; ++i) {
        const Vector3d a = (at.at(i) - point).normalized(), b = (at.at((i + 1) % 4) - point).normalized();
        sum += std::acos(std::min(1.0, a.dot(b))) / 2 * a.cross(b).normalized()[axis];
      }
      expected[axis] = sum / sr;
    }
    if (expected.dot(mean) < 0) expected = -expected;
    if (sr > 1e-6)  // below, the expectation is the one that rounding spoils
      EXPECT_LT((mean - expected).norm(), 2e-3) << point.transpose();  // the lattice's midpoint rule
  }
}

TEST(RectangleLightsTest, SeveralAreDrawnByLuminanceTimesSolidAngle) {
  const Lights lights({.rectangles = {panel(), tilted_panel()}});
  const Vector3d point(0, 0, 0);
  double mean = 0;
  constexpr int kSide = 40;
  for (int i = 0; i < kSide * kSide * kSide; ++i) {
    const Eigen::Vector3f u =
        (Eigen::Vector3i(i % kSide, i / kSide % kSide, i / kSide / kSide).cast<float>().array() + 0.5f) / kSide;
    const auto direction = lights.sample(point, u.z(), u.head<2>());
    ASSERT_TRUE(direction);
    mean += 1 / lights.pdf(point, *direction) / (kSide * kSide * kSide);
  }
  const double expected = solid_angle(panel(), point) + solid_angle(tilted_panel(), point);
  EXPECT_NEAR(mean, expected, 0.03 * expected);  // one stratum in forty of u_light holds both
  EXPECT_NEAR(lights.power(point), 6 * solid_angle(panel(), point) + 3 * solid_angle(tilted_panel(), point), 1e-12);
  EXPECT_FALSE(lights.sample({0, 0, 1000}, 0.5f, {0.5f, 0.5f})) << "behind both";
}

TEST(RectangleLightsTest, OnlyTheBrightSideOfTheNearestIsSeen) {
  RectangleLight high = panel();
  high.center.z() = 50;
  high.radiance = {9, 9, 9};
  RectangleLight low = panel();
  low.visible = false;
  const Lights lights({.rectangles = {high, low}});
  EXPECT_NEAR(lights.intersect({15, -8, 0}, Vector3d::UnitZ(), false)->distance, 40, 1e-12);
  EXPECT_EQ(lights.intersect({15, -8, 0}, Vector3d::UnitZ(), true)->radiance[0], 9);
  EXPECT_EQ(lights.intersect({15, -8, 45}, Vector3d::UnitZ(), false)->radiance[0], 9) << "past the lower one";
  EXPECT_FALSE(lights.intersect({15, -8, 60}, -Vector3d::UnitZ(), false)) << "from behind";
  EXPECT_FALSE(lights.intersect({15, 5, 0}, Vector3d::UnitZ(), false)) << "25 mm across y";
  EXPECT_TRUE(lights.intersect({44, -8, 0}, Vector3d::UnitZ(), false)) << "60 mm across x";
}

// A white floor seen from beside the light; light sampling and scattering sampling both meet it.
TEST(RectangleLightsTest, IrradianceOfAFloorIsLambertsClosedForm) {
  const TriangleMesh floor{.vertices = {{-500, -500, 0}, {500, -500, 0}, {500, 500, 0}, {-500, 500, 0}},
                           .triangles = {{0, 1, 2}, {0, 2, 3}},
                           .albedo = cv::Mat3f(1, 1, cv::Vec3f::all(0.5f))};
  for (RectangleLight light : {panel(), tilted_panel()}) {
    light.visible = false;
    for (const double height_mm : {40.0, 4.0}) {  // the low one fills half of what its middle sees
      light.center.z() = height_mm + std::abs(light.edge_y.z()) / 2;
      for (const Vector3d& at : {Vector3d(0, 0, 0), Vector3d(light.center.x(), light.center.y(), 0)}) {
        Camera camera = look_at(at + Vector3d(300, 0, 60), at, {0, 0, 1});
        camera.width = camera.height = 8;
        camera.fx = camera.fy = 3e4;  // 0.1 mm
        camera.cx = camera.cy = 3.5;
        const PathTracer tracer({.meshes = {floor}, .rectangles = {light}});
        const cv::Mat3f image = tracer.render(camera, {.samples_per_pixel = 256, .max_vertices = 1});
        const double expected = 0.5 / std::numbers::pi * irradiance(light, at, Vector3d::UnitZ());
        EXPECT_NEAR(cv::mean(image)[0], expected, 3e-3 * expected) << at.transpose();  // three standard errors
      }
    }
  }
}

TEST(RectangleLightsTest, BesideSpheresAndSurroundingsTheyAddUp) {
  const TriangleMesh floor{.vertices = {{-500, -500, 0}, {500, -500, 0}, {500, 500, 0}, {-500, 500, 0}},
                           .triangles = {{0, 1, 2}, {0, 2, 3}},
                           .albedo = cv::Mat3f(1, 1, cv::Vec3f::all(0.5f))};
  const SphereLight sphere{.center = {-60, 0, 70}, .radius_mm = 20, .radiance = {5, 5, 5}};
  const EnvironmentLight sky{.radiance = cv::Mat3f(4, 8, cv::Vec3f::all(0.3f))};
  Camera camera = look_at({0, 200, 100}, {0, 0, 0}, {0, 0, 1});
  camera.width = camera.height = 16;
  camera.fx = camera.fy = 3e3, camera.cx = camera.cy = 7.5;
  const auto lit_by = [&](const Scene& lights) {
    Scene scene = lights;
    scene.meshes = {floor};
    return cv::mean(PathTracer(scene).render(camera, {.samples_per_pixel = 256}))[0];
  };
  const double spheres = lit_by({.lights = {sphere}}), surroundings = lit_by({.surroundings = sky}),
               rectangles = lit_by({.rectangles = {panel()}});
  EXPECT_NEAR(lit_by({.lights = {sphere}, .rectangles = {panel()}}), spheres + rectangles,
              4e-3 * (spheres + rectangles));
  // Each hides the sky behind it, of a radiance of 0.3 instead of 5 and 3.
  const double all = spheres * (1 - 0.3 / 5) + rectangles * (1 - 0.3 / 3) + surroundings;
  EXPECT_NEAR(lit_by({.lights = {sphere}, .surroundings = sky, .rectangles = {panel()}}), all, 4e-3 * all);
}

TEST(RectangleLightsTest, CamerasSeeItUnlessItIsHidden) {
  Camera camera = look_at({15, -8, 0}, {15, -8, 40}, {0, 1, 0});
  camera.width = camera.height = 4;
  camera.cx = camera.cy = 1.5;
  RectangleLight light = panel();
  EXPECT_NEAR(cv::mean(PathTracer({.rectangles = {light}}).render(camera, {}))[1], 2, 1e-6);
  light.visible = false;
  EXPECT_EQ(cv::mean(PathTracer({.rectangles = {light}}).render(camera, {}))[1], 0);
}

}  // namespace
}  // namespace renderer

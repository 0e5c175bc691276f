#include "inversion/view.h"

#include <gtest/gtest.h>

#include <opencv2/imgproc.hpp>

#include "renderer/path_tracer.h"
#include "synthetic_spool.h"

namespace inversion {
namespace {

using Eigen::Vector3d;

TEST(ViewTest, ThreadsLieSideBySideAndTouchTheFrame) {
  WrappedSpool spool;
  spool.front_and_back = true;
  const std::vector<Segment3> lines = thread_lines(spool);
  ASSERT_EQ(lines.size(), 100U);
  for (std::size_t i = 0; i < 100; ++i) {
    const double x = i < 50 ? 0.25 : -3.25;  // a radius before the front, a radius behind the back
    EXPECT_TRUE(lines[i].from.isApprox(Vector3d(x, -34, lines[i].from.z())));
    EXPECT_TRUE(lines[i].to.isApprox(Vector3d(x, 34, lines[i].from.z())));
    EXPECT_NEAR(lines[i].from.z(), -12.25 + 0.5 * static_cast<double>(i % 50), 1e-12);
  }
}

TEST(ViewTest, TheDiffuserShowsWhatADiffuserInTheSceneShows) {
  NearLight light;
  light.position = {400, 0, 0};
  light.intensity = {5e5, 3e5, 1e5};
  light.beam_axis = Vector3d(-1, 0.3, 0).normalized();
  light.beam_exponent = 1.5;
  renderer::TriangleMesh white{.vertices = {{0, -5, -5}, {0, 5, -5}, {0, 5, 5}, {0, -5, 5}},
                               .triangles = {{0, 1, 2}, {0, 2, 3}},
                               .albedo = cv::Mat3f(1, 1, cv::Vec3f(1, 1, 1))};
  const renderer::PathTracer tracer({.meshes = {white}, .lights = {sphere_light(light)}});
  renderer::Camera camera = renderer::look_at({300, 100, 0}, {0, 0, 0}, {0, 0, 1});
  camera.width = camera.height = 4, camera.cx = camera.cy = 1.5;
  const cv::Scalar mean = cv::mean(tracer.render(camera, {.samples_per_pixel = 16, .max_vertices = 1}));
  for (int c = 0; c < 3; ++c)  // the lamp's size and the patch's matter by 1e-4
    EXPECT_NEAR(mean[c] / diffuser_radiance(light)[c], 1, 1e-3) << c;
}

TEST(ViewTest, TheMaskIsTheSheetWithoutItsBorder) {
  const WrappedSpool spool;
  const View view = unlit_view(spool, six_standpoints()[0], 90);
  // 50 threads of 0.5 mm over 68 mm; two pixels on every side are left out, and the edge's pixels may count or not.
  const double pixels_per_mm = view.camera.fx / 600;
  const cv::Rect box = cv::boundingRect(view.mask);
  EXPECT_NEAR(box.width, 68 * pixels_per_mm - 4, 2);
  EXPECT_NEAR(box.height, 25 * pixels_per_mm - 4, 2);
  EXPECT_EQ(cv::countNonZero(view.mask), box.area());
}

TEST(ViewTest, LitFromBehindTheMaskIsTheWindowOnly) {
  const WrappedSpool spool;
  const View view = unlit_view(spool, {"through", 0, 0, 180, 0}, 90);
  const double pixels_per_mm = view.camera.fx / 600;
  const cv::Rect box = cv::boundingRect(view.mask);
  // Light passes the window's edges by a part of the frame's depth and scatters along threads by a few diameters.
  EXPECT_GT(box.width, 30 * pixels_per_mm - 8);
  EXPECT_LT(box.width, 45 * pixels_per_mm);
  EXPECT_LT(box.height, 25 * pixels_per_mm);
}

}  // namespace
}  // namespace inversion

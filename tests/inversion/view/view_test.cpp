#include "inversion/view/view.h"

#include <gtest/gtest.h>

#include <opencv2/imgproc.hpp>

#include "renderer/trace/path_tracer.h"
#include "tests/inversion/fit/synthetic_spool.h"

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

TEST(ViewTest, AWidePicturesMaskIsANarrowOnesButForItsBorder) {
  const WrappedSpool spool;
  const View narrow = unlit_view(spool, six_standpoints()[1], 210);
  const cv::Rect few = cv::boundingRect(narrow.mask);
  renderer::Camera camera = narrow.camera;  // pixels of a tenth
  camera.width *= 10, camera.height *= 10, camera.fx *= 10, camera.fy *= 10;
  camera.cx = 10 * (camera.cx + 0.5) - 0.5, camera.cy = 10 * (camera.cy + 0.5) - 0.5;
  const int top = 10 * few.y - 100;
  const cv::Mat1b mask = thread_mask(spool, renderer::cut(camera, 0, top, camera.width, 200), narrow.light, 8);
  ASSERT_EQ(mask.size(), cv::Size(2100, 200));
  const cv::Rect threads = cv::boundingRect(mask);
  // The wide mask is made of pixels of three by three, two of which are left out at its border; the narrow picture's
  // mask leaves out two of ten by ten. So the borders are 1.4 narrow pixels apart, give or take the one that counts or
  // does not.
  EXPECT_EQ(threads.x % 3, 0);
  EXPECT_EQ(threads.width % 3, 0);
  EXPECT_NEAR(threads.x / 10.0, few.x - 1.4, 1);
  EXPECT_NEAR(threads.br().x / 10.0, few.br().x + 1.4, 1);
  EXPECT_NEAR((top + threads.y) / 10.0, few.y - 1.4, 1);
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

#include "renderer/picture/camera.h"

#include <gtest/gtest.h>

#include <opencv2/calib3d.hpp>

namespace renderer {
namespace {

Camera distorted_camera() {
  Camera camera = look_at({500, 40, 120}, {0, 0, 60}, {0, 0, 1});
  camera.fx = 1010, camera.fy = 1005, camera.cx = 310, camera.cy = 190;
  camera.distortion = {-0.12, 0.05, 1e-3, -8e-4, 0.01};
  return camera;
}

TEST(CameraTest, RayThroughAPixelProjectsBackToThatPixel) {
  const Camera camera = distorted_camera();
  for (double row : {-0.5, 0.0, 120.3, 399.5}) {
    for (double column : {-0.5, 10.0, 333.3, 599.5}) {
      const CameraRay ray = ray_through(camera, column, row);
      EXPECT_NEAR(ray.direction.norm(), 1, 1e-12);
      const Eigen::Vector2d pixel = project(camera, ray.origin + 321 * ray.direction);
      EXPECT_NEAR(pixel.x(), column, 1e-9);  // the lens is inverted to rounding
      EXPECT_NEAR(pixel.y(), row, 1e-9);
    }
  }
}

TEST(CameraTest, ProjectionIsOpenCvsProjection) {
  const Camera camera = distorted_camera();
  const Eigen::Vector3d point(12, -30, 70);
  const Eigen::Isometry3d camera_from_world = camera.world_from_camera.inverse();
  const Eigen::Vector3d in_camera = camera_from_world * point;
  std::vector<cv::Point2d> expected;
  const cv::Matx33d intrinsics(camera.fx, 0, camera.cx, 0, camera.fy, camera.cy, 0, 0, 1);
  cv::projectPoints(std::vector<cv::Point3d>{{in_camera.x(), in_camera.y(), in_camera.z()}}, cv::Vec3d(), cv::Vec3d(),
                    intrinsics, std::vector<double>(camera.distortion.begin(), camera.distortion.end()), expected);
  const Eigen::Vector2d pixel = project(camera, point);
  EXPECT_NEAR(pixel.x(), expected[0].x, 1e-9);
  EXPECT_NEAR(pixel.y(), expected[0].y, 1e-9);
}

TEST(CameraTest, APartOfThePictureAndLargerPixelsSeeTheSamePoint) {
  const Camera camera = distorted_camera();
  const Eigen::Vector3d point(12, -30, 70);
  const Eigen::Vector2d pixel = project(camera, point);
  const Camera part = cut(camera, 21, 40, 300, 200), larger = with_larger_pixels(camera, 7);
  EXPECT_LT((project(part, point) - (pixel - Eigen::Vector2d(21, 40))).norm(), 1e-9);
  EXPECT_EQ(part.height, 200);
  // The first large pixel's centre is the fourth small one's.
  EXPECT_LT((project(larger, point) - (pixel - Eigen::Vector2d(3, 3)) / 7).norm(), 1e-9);
  EXPECT_EQ(larger.width, 86);  // 600 / 7, rounded up
}

TEST(CameraTest, LookAtCentresTheTargetWithUpUpwards) {
  Camera camera = look_at({500, 40, 120}, {0, 0, 60}, {0, 0, 1});
  const Eigen::Vector2d target = project(camera, {0, 0, 60});
  EXPECT_NEAR(target.x(), camera.cx, 1e-9);
  EXPECT_NEAR(target.y(), camera.cy, 1e-9);
  EXPECT_LT(project(camera, {0, 0, 70}).y(), target.y());  // rows grow downwards
  EXPECT_NEAR(camera.world_from_camera.linear().determinant(), 1, 1e-12);
}

TEST(CameraTest, RaysThroughTheLensMeetInThePlaneOfFocus) {
  Camera camera = distorted_camera();
  camera.aperture_mm = 30, camera.focus_mm = 420;
  const CameraRay pinhole = ray_through(camera, 33, 310);
  const Eigen::Vector3d forward = camera.world_from_camera.linear().col(2);
  const Eigen::Vector3d in_focus = pinhole.origin + pinhole.direction * (420 / pinhole.direction.dot(forward));
  for (const Eigen::Vector2d& lens : {Eigen::Vector2d(1, 0), Eigen::Vector2d(-0.3, 0.6)}) {
    const CameraRay ray = ray_through_lens(camera, pinhole, lens);
    EXPECT_NEAR((ray.origin - pinhole.origin).norm(), 15 * lens.norm(), 1e-9);
    EXPECT_NEAR((ray.origin - pinhole.origin).dot(forward), 0, 1e-9);
    EXPECT_LT((in_focus - ray.origin).cross(ray.direction).norm(), 1e-9);
    EXPECT_NEAR(ray.direction.norm(), 1, 1e-12);
  }
}

}  // namespace
}  // namespace renderer

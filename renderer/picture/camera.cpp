#include "renderer/picture/camera.h"

#include <Eigen/LU>
#include <cmath>
#include <stdexcept>

namespace renderer {
namespace {

using Eigen::Matrix2d;
using Eigen::Vector2d;

bool is_ideal(const std::array<double, 5>& distortion) {
  return distortion == std::array<double, 5>{};
}

struct Distorted {
  Vector2d position;
  Matrix2d jacobian;  // d position / d undistorted
};

// OpenCV's model: radial k1 k2 k3, tangential p1 p2, on the plane z = 1.
Distorted distort(const std::array<double, 5>& distortion, const Vector2d& undistorted) {
  const auto [k1, k2, p1, p2, k3] = distortion;
  const double x = undistorted.x(), y = undistorted.y(), r2 = x * x + y * y;
  const double radial = 1 + r2 * (k1 + r2 * (k2 + r2 * k3));
  const double slope = k1 + r2 * (2 * k2 + r2 * 3 * k3);  // d radial / d r2
  Distorted out;
  out.position = {x * radial + 2 * p1 * x * y + p2 * (r2 + 2 * x * x),
                  y * radial + p1 * (r2 + 2 * y * y) + 2 * p2 * x * y};
  out.jacobian << radial + 2 * x * x * slope + 2 * p1 * y + 6 * p2 * x, 2 * x * y * slope + 2 * p1 * x + 2 * p2 * y,
      2 * x * y * slope + 2 * p1 * x + 2 * p2 * y, radial + 2 * y * y * slope + 6 * p1 * y + 2 * p2 * x;
  return out;
}

// A few fixed-point steps reach Newton's basin from far corners; Newton then doubles the digits each step.
Vector2d undistort(const std::array<double, 5>& distortion, const Vector2d& distorted) {
  Vector2d guess = distorted;
  for (int i = 0; i < 3; ++i) guess -= distort(distortion, guess).position - distorted;
  for (int i = 0; i < 20; ++i) {
    const Distorted at = distort(distortion, guess);
    const Vector2d step = at.jacobian.inverse() * (distorted - at.position);
    guess += step;
    if (step.squaredNorm() < 1e-28) return guess;
  }
  if (guess.allFinite() && (distort(distortion, guess).position - distorted).norm() < 1e-9) return guess;
  throw std::runtime_error(
      "camera: the lens distortion cannot be inverted at a pixel of the picture; check k1 k2 p1 p2 k3");
}

}  // namespace

CameraRay ray_through(const Camera& camera, double column, double row) {
  Vector2d plane{(column - camera.cx) / camera.fx, (row - camera.cy) / camera.fy};
  if (!is_ideal(camera.distortion)) plane = undistort(camera.distortion, plane);
  const Eigen::Vector3d direction_camera = plane.homogeneous().normalized();
  return {camera.world_from_camera.translation(), camera.world_from_camera.linear() * direction_camera};
}

CameraRay ray_through_lens(const Camera& camera, const CameraRay& pinhole, const Eigen::Vector2d& lens) {
  const auto axes = camera.world_from_camera.linear();
  const Eigen::Vector3d in_focus =
      pinhole.origin + pinhole.direction * (camera.focus_mm / pinhole.direction.dot(axes.col(2)));
  const Eigen::Vector3d origin = pinhole.origin + axes.leftCols<2>() * (camera.aperture_mm / 2 * lens);
  return {origin, (in_focus - origin).normalized()};
}

double circle_of_confusion_px(const Camera& camera, double depth_mm) {
  return camera.fx * camera.aperture_mm * std::abs(1 / camera.focus_mm - 1 / depth_mm);
}

Eigen::Vector2d project(const Camera& camera, const Eigen::Vector3d& point_world) {
  const Eigen::Vector3d point_camera = camera.world_from_camera.inverse() * point_world;
  const Vector2d plane = distort(camera.distortion, point_camera.hnormalized()).position;
  return {camera.fx * plane.x() + camera.cx, camera.fy * plane.y() + camera.cy};
}

Camera with_larger_pixels(const Camera& camera, int factor) {
  Camera larger = camera;
  larger.width = (camera.width + factor - 1) / factor, larger.height = (camera.height + factor - 1) / factor;
  larger.fx /= factor, larger.fy /= factor;
  larger.cx = (camera.cx + 0.5) / factor - 0.5, larger.cy = (camera.cy + 0.5) / factor - 0.5;
  return larger;
}

Camera cut(const Camera& camera, int left, int top, int width, int height) {
  Camera part = camera;
  part.width = width, part.height = height;
  part.cx -= left, part.cy -= top;
  return part;
}

Camera look_at(const Eigen::Vector3d& eye, const Eigen::Vector3d& target, const Eigen::Vector3d& up) {
  const Eigen::Vector3d forward = (target - eye).normalized();
  const Eigen::Vector3d right = forward.cross(up).normalized();
  Camera camera;
  camera.world_from_camera.linear() << right, forward.cross(right), forward;
  camera.world_from_camera.translation() = eye;
  return camera;
}

bool advance_to(const Eigen::AlignedBox3d& box, CameraRay& ray) {
  double entry = 0, leave = std::numeric_limits<double>::infinity();
  for (int axis = 0; axis < 3; ++axis) {
    const double inverse = 1 / ray.direction[axis];
    double near = (box.min()[axis] - ray.origin[axis]) * inverse;
    double far = (box.max()[axis] - ray.origin[axis]) * inverse;
    if (near > far) std::swap(near, far);
    entry = std::max(entry, near);  // a NaN (origin on a slab's plane, parallel to it) leaves the bounds as they are
    leave = std::min(leave, far);
  }
  const double margin = 1e-5 * box.diagonal().norm();
  if (box.isEmpty() || entry > leave + margin) return false;
  ray.origin += std::max(0.0, entry - margin) * ray.direction;
  return true;
}

}  // namespace renderer

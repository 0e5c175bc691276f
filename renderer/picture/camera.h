// A camera with the OpenCV lens model, as the renderer traces it: a pinhole, or a thin lens that blurs what is out of
// focus.
//
// Frames: OpenCV camera axes (+z forward, +x right, +y down); the centre of the first pixel is at (0, 0).
// Units: millimetres for poses, pixels for intrinsics.
#pragma once

#include <Eigen/Geometry>
#include <array>

namespace renderer {

struct Camera {
  int width = 600;
  int height = 400;
  double fx = 600.0, fy = 600.0;       // focal lengths, pixels
  double cx = 299.5, cy = 199.5;       // principal point, pixels
  std::array<double, 5> distortion{};  // k1 k2 p1 p2 k3 (OpenCV order); zeros = ideal pinhole
  Eigen::Isometry3d world_from_camera = Eigen::Isometry3d::Identity();
  // The diameter of a round thin lens at the camera's origin; 0: a pinhole. The plane z = focus_mm of the camera's
  // frame is sharp, and appears where a pinhole would show it.
  double aperture_mm = 0.0;
  double focus_mm = 1000.0;
};

struct CameraRay {
  Eigen::Vector3d origin;     // mm, world
  Eigen::Vector3d direction;  // unit, world
};

// The ray through the continuous pixel position (column, row); (0, 0) is the centre of the first pixel.
CameraRay ray_through(const Camera& camera, double column, double row);

// The ray from the point of the lens at `lens` (unit disc) that meets `pinhole`, the ray through the middle of the
// lens, in the plane of focus.
CameraRay ray_through_lens(const Camera& camera, const CameraRay& pinhole, const Eigen::Vector2d& lens);

// The diameter, in pixels, of the disc over which a point at z = depth_mm of the camera's frame is spread: the circle
// of confusion, near the axis.
double circle_of_confusion_px(const Camera& camera, double depth_mm);

// The pixel position of a world point in front of the camera, distortion included.
Eigen::Vector2d project(const Camera& camera, const Eigen::Vector3d& point_world);

// The same camera with pixels that are each as large as `factor` x `factor` of its own; the last ones may reach beyond
// its picture.
Camera with_larger_pixels(const Camera& camera, int factor);

// The same camera for the part of its picture that begins at (left, top) and has this size, in pixels.
Camera cut(const Camera& camera, int left, int top, int width, int height);

// A camera at `eye` looking at `target`; `up` shows upwards in the picture. Intrinsics are left at their defaults.
Camera look_at(const Eigen::Vector3d& eye, const Eigen::Vector3d& target, const Eigen::Vector3d& up);

// Moves a ray's origin to where it enters the box, in double, so that float rays are exact near the surfaces. Returns
// false when the ray misses the box.
bool advance_to(const Eigen::AlignedBox3d& box, CameraRay& ray);

}  // namespace renderer

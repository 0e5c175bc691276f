#include "renderer/picture/pixel_rays.h"

#include <cmath>
#include <numbers>

namespace renderer {
namespace {

// A point of the unit disc, uniform over its area; radius and angle keep the even spacing of u in rings.
Eigen::Vector2d in_unit_disc(const Eigen::Vector2f& u) {
  const double radius = std::sqrt(static_cast<double>(u.x())),
               angle = 2 * std::numbers::pi * static_cast<double>(u.y());
  return {radius * std::cos(angle), radius * std::sin(angle)};
}

}  // namespace

std::uint64_t pixel_number(const Camera& camera, int column, int row) {
  return static_cast<std::uint64_t>(row) * static_cast<std::uint64_t>(camera.width) +
         static_cast<std::uint64_t>(column);
}

PixelRays::PixelRays(const Camera& camera, int column, int row, int width, int height)
    : column_(column), row_(row), width_(width), camera_(camera) {
  const Eigen::Vector3d forward = camera.world_from_camera.linear().col(2);
  corners_.reserve(static_cast<std::size_t>(width + 1) * static_cast<std::size_t>(height + 1));
  for (int y = 0; y <= height; ++y) {
    for (int x = 0; x <= width; ++x) {
      const Eigen::Vector3d direction = ray_through(camera, column + x - 0.5, row + y - 0.5).direction;
      corners_.push_back(direction / direction.dot(forward));
    }
  }
}

CameraRay PixelRays::sample(int column, int row, Sampler& sampler) const {
  const CameraRay pinhole = at(column, row, sampler.next_2d());
  if (camera_.aperture_mm == 0) return pinhole;
  return ray_through_lens(camera_, pinhole, in_unit_disc(sampler.next_2d()));
}

CameraRay PixelRays::at(int column, int row, const Eigen::Vector2f& u) const {
  const auto stride = static_cast<std::size_t>(width_ + 1);
  const Eigen::Vector3d* corner =
      &corners_[static_cast<std::size_t>(row - row_) * stride + static_cast<std::size_t>(column - column_)];
  const double x = static_cast<double>(u.x()), y = static_cast<double>(u.y());
  const Eigen::Vector3d top = corner[0] + x * (corner[1] - corner[0]);
  const Eigen::Vector3d bottom = corner[stride] + x * (corner[stride + 1] - corner[stride]);
  return {camera_.world_from_camera.translation(), (top + y * (bottom - top)).normalized()};
}

}  // namespace renderer

// The camera rays of one tile of a picture. The lens is inverted at pixel corners only; directions are interpolated
// inside pixels, where the lens's curvature is below 1e-4 pixel.
#pragma once

#include <vector>

#include "renderer/picture/camera.h"
#include "renderer/picture/sampler.h"

namespace renderer {

// The number of a pixel among all, by rows, which tells its sampler apart from the others'.
std::uint64_t pixel_number(const Camera& camera, int column, int row);

class PixelRays {
 public:
  // For the pixels [column, column + width) x [row, row + height).
  PixelRays(const Camera& camera, int column, int row, int width, int height);
  // The ray through pixel (column, row) at offset u in [0, 1)^2 inside it; (0.5, 0.5) is its centre.
  CameraRay at(int column, int row, const Eigen::Vector2f& u) const;
  // A random ray through the pixel, from the pinhole or from anywhere on the lens, by the sampler's next numbers.
  CameraRay sample(int column, int row, Sampler& sampler) const;

 private:
  int column_, row_, width_;
  Camera camera_;
  std::vector<Eigen::Vector3d> corners_;  // directions scaled to camera z = 1, row-major, (height + 1) x (width + 1)
};

}  // namespace renderer
